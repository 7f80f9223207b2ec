"""The site of the documentation: it builds strictly, its links lead somewhere, a browser shows it without complaint."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from functools import partial
from html.parser import HTMLParser
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from importlib.util import find_spec
from pathlib import Path
from posixpath import dirname, join, normpath
from threading import Thread
from urllib.parse import unquote, urlsplit

import chromium
import pytest

from ltlc.base.codes import CODES

ROOT = Path(__file__).parents[1]

pytestmark = pytest.mark.skipif(find_spec("material") is None, reason="no mkdocs-material here (the extra `docs`)")
in_a_browser = pytest.mark.skipif(bool(chromium.MISSING), reason=chromium.MISSING)

LOOKED_AT = ("index", "tutorial", "patterns", "language", "codes/index")


class Page(HTMLParser):
    """What a page links to, what it loads by itself, and the places in it that can be linked to."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.links: list[str] = []
        self.loads: list[str] = []
        self.places = {""}
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        given = {name: value or "" for name, value in attributes}
        self.places |= {given["id"]} if "id" in given else set()
        if tag == "a" and "href" in given:
            self.links.append(given["href"])
        elif "src" in given or tag == "link":
            self.loads.append(given.get("src") or given["href"])


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site as `scripts/docs` builds it."""
    folder = tmp_path_factory.mktemp("docs") / "site"
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(folder)]
    environment = {**os.environ, "NO_MKDOCS_2_WARNING": "1"}
    built = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert built.returncode == 0, built.stderr
    return folder


@pytest.fixture(scope="module")
def pages(site: Path) -> dict[str, Page]:
    """The pages, by where they are in the site."""
    return {path.relative_to(site).as_posix(): Page(path) for path in site.rglob("*.html") if path.name != "404.html"}


def test_every_link_within_the_site_leads_to_a_place_that_is_there(pages: dict[str, Page], site: Path) -> None:
    files = {path.relative_to(site).as_posix() for path in site.rglob("*") if path.is_file()}
    for name, page in pages.items():
        for link in filter(lambda each: not urlsplit(each).scheme, page.links + page.loads):
            path, _, place = unquote(link).partition("#")
            target = normpath(join(dirname(name), path)) if path else name
            assert target in files, f"{name}: {link}"
            assert target not in pages or place in pages[target].places, f"{name}: {link}"


def test_every_link_to_elsewhere_is_an_address(pages: dict[str, Page]) -> None:
    links = {link for page in pages.values() for link in page.links if urlsplit(link).scheme}
    assert links
    for link in links:
        assert urlsplit(link).scheme in {"http", "https"}, link
        assert "." in (urlsplit(link).hostname or ""), link


def test_the_site_loads_nothing_from_elsewhere(pages: dict[str, Page], site: Path) -> None:
    loaded = [load for page in pages.values() for load in page.loads]
    loaded += [url for sheet in site.rglob("*.css") for url in re.findall(r"url\(([^)]*)\)", sheet.read_text())]
    assert [load for load in loaded if re.match(r"['\"]?(https?:)?//", load)] == []


def test_every_code_has_its_page_in_the_site(site: Path) -> None:
    assert {path.stem for path in (site / "codes").glob("LTL*.html")} == set(CODES)


def test_codes_in_running_text_are_links(pages: dict[str, Page]) -> None:
    assert "codes/LTL806.html" in pages["recordings.html"].links
    assert "LTL804.html" in pages["codes/LTL815.html"].links
    assert "codes/LTL904.html" not in pages["tutorial.html"].links, "there it stands in listings only"


def test_pictures_in_the_site_are_made_by_ltlc(site: Path) -> None:
    tutorial = (site / "tutorial.html").read_text(encoding="utf-8")
    assert "<title>state 2: violated</title>" in tutorial
    assert "<!-- " not in re.sub(r"<head>.*?</head>|<script.*?</script>", "", tutorial, flags=re.DOTALL)
    assert "watch.txt on drive" in (site / "first_drive.html").read_text(encoding="utf-8")


def test_the_site_does_not_tell_where_it_was_built(site: Path) -> None:
    built = [path for path in site.rglob("*") if path.suffix in {".html", ".json", ".xml"}]
    assert [path.name for path in built if str(ROOT) in path.read_text(encoding="utf-8")] == []


class Quiet(SimpleHTTPRequestHandler):
    """Serves a folder, without a word."""

    def log_message(self, *_: object) -> None: ...


@pytest.fixture(scope="module")
def address(site: Path) -> Iterator[str]:
    with ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=site)) as server:
        Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[chromium.Browser]:
    with chromium.browser(tmp_path_factory.mktemp("chromium")) as opened:
        yield opened


@pytest.mark.live
@in_a_browser
@pytest.mark.parametrize("width", [400, 1280])
@pytest.mark.parametrize("name", LOOKED_AT)
def test_a_page_fits_the_window_and_nothing_fails(
    browser: chromium.Browser, address: str, name: str, width: int
) -> None:
    browser.visit(f"{address}/{name}.html", width)
    assert browser.run("return document.documentElement.scrollWidth") == width
    assert [each for each in browser.complaints() if "favicon.ico" not in each] == []


@pytest.mark.live
@in_a_browser
def test_the_search_finds_pages(browser: chromium.Browser, address: str) -> None:
    browser.visit(f"{address}/index.html?q=patrolling")
    browser.wait_until("return document.querySelector('.md-search-result__link[href*=\"patterns.html\"]')")
    assert browser.complaints() == []


@pytest.mark.live
@in_a_browser
def test_the_site_and_its_pictures_are_dark_for_those_who_want_it_dark(browser: chromium.Browser, address: str) -> None:
    browser.visit(f"{address}/tutorial.html", scheme="dark")
    browser.wait_until("return document.body.getAttribute('data-md-color-scheme') === 'slate'")
    style = "return getComputedStyle(document.querySelector('{}')).{}"
    assert browser.run(style.format(".monitor .name", "fill")) == browser.run(style.format("article p", "color"))
