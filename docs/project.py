"""Adds the documents at the root of the repository to the site, with their links rewritten."""

import re
from pathlib import Path

from mkdocs.structure.files import File

ROOT = Path(__file__).parent.parent
PAGES = {"CONTRIBUTING.md": "contributing.md", "ARCHITECTURE.md": "architecture.md", "SECURITY.md": "security.md", "CHANGELOG.md": "changelog.md"}


def on_files(files, config):
    for source, page in PAGES.items():
        text = re.sub(r"\[([^\]]+)\]\(([^)#\s]+)(#[^)]*)?\)", link, (ROOT / source).read_text())
        files.append(File.generated(config, f"project/{page}", content=text))
    return files


def link(match):
    """Points a link at the site, or keeps only its text if the target is not part of the site."""
    text, target, anchor = match[1], match[2], match[3] or ""
    if "://" in target:
        return match[0]
    if target in PAGES:
        return f"[{text}]({PAGES[target]}{anchor})"
    if target.startswith("docs/"):
        target = target.removeprefix("docs/")
        return f"[{text}](../{target if Path(target).suffix else target.rstrip('/') + '/README.md'}{anchor})"
    return text
