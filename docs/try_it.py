"""Puts the playground on the site, and a link below every program that opens the program there."""

import base64
import json
import re
import zlib
from pathlib import Path

from mkdocs.structure.files import File
from mkdocs.utils import get_relative_url

PLAYGROUND = Path(__file__).parent.parent / "playground" / "dist"
PROGRAM = re.compile(r"^(?P<indent> *)```sa\n(?P<text>.*?)^(?P=indent)```$", re.MULTILINE | re.DOTALL)


def on_files(files, config):
    """Adds the files of the playground."""
    for path in sorted(PLAYGROUND.rglob("*")):
        if path.is_file():
            name = f"playground/{path.relative_to(PLAYGROUND)}"
            files.append(File.generated(config, name, abs_src_path=str(path)))
    return files


def on_page_markdown(markdown, page, config, files):
    """Adds the links. Without a built playground, the page stays as it is."""
    if not PLAYGROUND.is_dir():
        return markdown
    playground = get_relative_url("playground/index.html", page.url)

    def with_link(block):
        indent = block["indent"]
        text = re.sub(f"^{indent}", "", block["text"], flags=re.MULTILINE)
        return f"{block[0]}\n\n{indent}[Try it]({playground}{fragment(text)}){{ .try-it }}\n"

    return PROGRAM.sub(with_link, markdown)


def fragment(text):
    """Returns the part of a link after the page, as `playground/web/src/share.js` reads it."""
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    packed = packer.compress(json.dumps({"text": text}).encode()) + packer.flush()
    return "#p=" + base64.urlsafe_b64encode(packed).decode().rstrip("=")
