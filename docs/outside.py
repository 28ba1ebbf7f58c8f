"""mdBook preprocessor: replaces links to files outside docs by their labels and copies nothing."""
import json
import os
import re
import sys

LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)")


def is_outside(page: str, target: str) -> bool:
    if re.match(r"[a-z]+:|#", target):
        return False
    path = os.path.normpath(os.path.join(os.path.dirname(page), target.split("#")[0]))
    return path.startswith("..")


def rewrite(page: str, text: str) -> str:
    def replacement(match: re.Match) -> str:
        image, label, target = match.groups()
        return (label if not image else "") if is_outside(page, target) else match.group(0)

    return LINK.sub(replacement, text)


def visit(items: list) -> None:
    for item in items:
        chapter = item.get("Chapter") if isinstance(item, dict) else None
        if chapter:
            if chapter["path"]:
                chapter["content"] = rewrite(chapter["path"], chapter["content"])
            visit(chapter["sub_items"])


if len(sys.argv) > 1 and sys.argv[1] == "supports":
    sys.exit(0)
_context, book = json.load(sys.stdin)
visit(book.get("sections") or book.get("items"))
json.dump(book, sys.stdout)
