"""Lists and calls every tool and reads every resource with the client of the official package."""
import asyncio
import json
import os

from mcp import ClientSession, StdioServerParameters
from mcp.client.stdio import stdio_client

PROGRAM = os.environ["NOVAMIND"]


async def main():
    server = StdioServerParameters(
        command=PROGRAM, args=["mcp", "--new", "--seed", "7", "--days", "28", "--mode", "sandbox"], env=dict(os.environ)
    )
    documents = {tool["name"]: tool for tool in json.loads(os.popen(f"{PROGRAM} tools --json").read())}
    async with stdio_client(server) as (read, write), ClientSession(read, write) as session:
        await session.initialize()
        tools = (await session.list_tools()).tools
        accepted = 0
        # The week comes last, because earlier calls belong to it.
        for tool in sorted(tools, key=lambda tool: tool.name == "next_week"):
            answer = await session.call_tool(tool.name, documents[tool.name]["example"])
            assert answer.content, tool.name
            accepted += not (getattr(answer, "isError", None) or getattr(answer, "is_error", None))
        assert accepted > 20, accepted
        resources = (await session.list_resources()).resources
        for resource in resources:
            assert (await session.read_resource(resource.uri)).contents, resource.uri
    print(f"{len(tools)} tools listed and called, {accepted} accepted their example; {len(resources)} resources read")


asyncio.run(main())
