"""The connection to the run that is served on this machine.

The port comes from the environment variable NOVAMIND_API_PORT, the token, if the server asks for one, from
NOVAMIND_API_TOKEN.
"""
from __future__ import annotations

import json
import os
from http.client import HTTPConnection, HTTPException
from typing import Any, Dict, Optional, Tuple

#: Seconds that an answer is waited for; a week of a large company takes a few.
TIMEOUT = 1800.0


class NovamindError(Exception):
    """A refusal, or a server that does not answer. Its text says what is wrong; ``code`` and ``field`` are for programs."""

    def __init__(self, message: str, code: Optional[str] = None, field: Optional[str] = None) -> None:
        super().__init__(message)
        self.code = code
        self.field = field


_connection: Optional[Tuple[int, HTTPConnection]] = None


def _port() -> int:
    text = os.environ.get("NOVAMIND_API_PORT", "")
    if not text.isdigit():
        raise NovamindError("NOVAMIND_API_PORT does not hold the port of a server; start one with: novamind serve", "no_port")
    return int(text)


def _connected(port: int) -> HTTPConnection:
    global _connection
    if _connection is None or _connection[0] != port:
        _connection = (port, HTTPConnection("127.0.0.1", port, timeout=TIMEOUT))
    return _connection[1]


def _close() -> None:
    global _connection
    if _connection is not None:
        _connection[1].close()
        _connection = None


def request(method: str, path: str, body: Optional[Dict[str, Any]] = None) -> Dict[str, Any]:
    """Sends one request and returns its JSON, whatever it says.

    A connection that the server closed since the last request is opened again; a request that may have been received is
    never sent twice.

    Raises:
        NovamindError: no server answers, or it wants a token that was not given (code ``token``).
    """
    headers = {"Content-Type": "application/json"}
    token = os.environ.get("NOVAMIND_API_TOKEN", "").strip()
    if any(letter.isspace() or not letter.isascii() for letter in token):
        raise NovamindError("NOVAMIND_API_TOKEN holds more than a token", "token")
    if token:
        headers["Authorization"] = "Bearer " + token
    payload = None if body is None else json.dumps(body).encode()
    port = _port()
    connection = _connected(port)
    try:
        if connection.sock is not None and _closed_by_server(connection):
            connection.close()
        connection.request(method, path, payload, headers)
        response = connection.getresponse()
        text = response.read()
    except (OSError, HTTPException) as error:
        _close()
        raise NovamindError(f"the server on port {port} does not answer: {error}", "no_server") from error
    try:
        answer = json.loads(text)
    except ValueError as error:
        raise NovamindError("the server answered something else than JSON", "no_json") from error
    if response.status == 401:
        said = answer.get("error") if isinstance(answer, dict) else None
        raise NovamindError(
            f"{said or 'the server wants a token'}; set NOVAMIND_API_TOKEN to the text of the file named by --token",
            "token",
        )
    return answer


def _closed_by_server(connection: HTTPConnection) -> bool:
    """Whether the other end has closed: then there is something to read, which is the end."""
    import select

    readable, _, _ = select.select([connection.sock], [], [], 0)
    return bool(readable)


def checked(answer: Dict[str, Any]) -> Dict[str, Any]:
    """The answer, unless it is a refusal.

    Raises:
        NovamindError: what was refused, and why.
    """
    if answer.get("success") is False:
        raise NovamindError(str(answer.get("error")), answer.get("code"), answer.get("field"))
    return answer


def call(tool: str, arguments: Dict[str, Any]) -> Any:
    """Calls a tool with the arguments that are not None, and returns its data.

    Raises:
        NovamindError: the refusal of the tool.
    """
    given = {name: value for name, value in arguments.items() if value is not None}
    return checked(request("POST", "/call", {"tool": tool, "args": given})).get("data")
