"""Checks that every link in the built book has an existing page and anchor as its target. Usage: check_book.py DIR"""
import html.parser
import pathlib
import sys
import urllib.parse


class Page(html.parser.HTMLParser):
    def __init__(self, text: str) -> None:
        super().__init__()
        self.links, self.anchors = [], set()
        self.feed(text)

    def handle_starttag(self, tag: str, attributes: list) -> None:
        values = dict(attributes)
        self.links += [values[name] for name in ("href", "src") if values.get(name)]
        self.anchors |= {values[name] for name in ("id", "name") if values.get(name)}


root = pathlib.Path(sys.argv[1]).resolve()
pages = {path: Page(path.read_text(encoding="utf-8")) for path in root.rglob("*.html") if path.name != "print.html"}
dead = []
for path, page in pages.items():
    for link in page.links:
        parts = urllib.parse.urlsplit(link)
        if parts.scheme or link.startswith("//"):
            continue
        target = (path.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else path
        anchor = urllib.parse.unquote(parts.fragment)
        missing_anchor = anchor and target in pages and anchor not in pages[target].anchors
        if target.name != "print.html" and (not target.exists() or missing_anchor):
            dead.append(f"{path.relative_to(root)}: {link}")
assert len(pages) > 50, "the book has pages"
print("\n".join(dead) or f"{len(pages)} pages, no dead links")
sys.exit(bool(dead))
