"""Hooks of mkdocs.yml. The home page is README.md, and CONTRIBUTING.md and CHANGELOG.md are pages, too; links
between these, the pages of docs/ and other files of the repository are turned to where they are in the site."""
import pathlib
import posixpath
import re

from mkdocs.structure.files import File

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGES = {"README.md": "index.md", "CONTRIBUTING.md": "contributing.md", "CHANGELOG.md": "changelog.md"}
LINK = re.compile(r"(\]\()([^)\s#]+)(#[^)\s]*)?\)")


def in_site(path):
    """Where a file of the repository is in the site's sources."""
    if path in PAGES:
        return PAGES[path]
    return path[len("docs/"):] if path.startswith("docs/") else "source/" + path


def in_repository(page):
    if page.startswith("source/"):
        return page[len("source/"):]
    return next((path for path, name in PAGES.items() if name == page), "docs/" + page)


def targets(path, text):
    """The files of the repository that a page at `path` links to."""
    for match in LINK.finditer(text):
        if "://" not in match[2]:
            yield posixpath.normpath(posixpath.join(posixpath.dirname(path), match[2]))


def on_files(files, config):
    for path, name in PAGES.items():
        files.append(File.generated(config, name, content=(ROOT / path).read_text()))
    # What pages name and the site would not have: sources, licence, read-mes of folders and what these name.
    pages = list(files.documentation_pages())
    while pages:
        page = pages.pop()
        for target in targets(in_repository(page.src_uri), page.content_string):
            name = in_site(target)
            if name.startswith("source/") and (ROOT / target).is_file() and name not in files.src_uris:
                files.append(File.generated(config, name, abs_src_path=str(ROOT / target)))
                if name.endswith(".md"):
                    pages.append(files.src_uris[name])
    return files


def on_page_markdown(markdown, page, config, files):
    here = page.file.src_uri
    path = in_repository(here)

    def turned(match):
        if "://" in match[2]:
            return match[0]
        target = posixpath.normpath(posixpath.join(posixpath.dirname(path), match[2]))
        link = posixpath.relpath(in_site(target), posixpath.dirname(here) or ".")
        return f"{match[1]}{link}{match[3] or ''})"

    return LINK.sub(turned, markdown)
