"""The built book as one file: a zip to hand out, a PDF to print."""

from __future__ import annotations

import html
import re
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path

from book_pages import CACHE, HTML, ROOT, in_order

PRINTING = (
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--no-pdf-header-footer", "--virtual-time-budget=15000",
)  # fmt: skip


def pack() -> Path:
    """The folder to hand out, as one zip that opens by double click on index.html."""
    target = ROOT / "dist/book"
    target.parent.mkdir(exist_ok=True)
    stage = CACHE / "stage"
    shutil.rmtree(stage, ignore_errors=True)
    skipped = shutil.ignore_patterns(".buildinfo", "objects.inv", "_sources")
    shutil.copytree(HTML, stage / "book", ignore=skipped)
    made = Path(shutil.make_archive(str(target), "zip", stage, "book"))
    shutil.rmtree(stage)
    return made


def print_pdf(progress: Callable[[str], None]) -> Path:
    """Every page printed by Chromium, one after another, in the order of the contents."""
    from pypdf import PdfWriter

    browser = shutil.which("chromium") or shutil.which("google-chrome")
    if browser is None:
        raise SystemExit("printing needs Chromium: apt-get install chromium")
    target = ROOT / "dist/book.pdf"
    target.parent.mkdir(exist_ok=True)
    pages = in_order()
    with tempfile.TemporaryDirectory() as folder, PdfWriter() as whole:
        for k, page in enumerate(pages, start=1):
            sheet = Path(folder) / f"{k}.pdf"
            command = [browser, *PRINTING, f"--user-data-dir={folder}/profile"]
            command += [f"--print-to-pdf={sheet}", (HTML / f"{page}.html").as_uri()]
            subprocess.run(command, check=True, capture_output=True, timeout=120)
            whole.append(sheet, outline_item=_heading(page))
            progress(f"printing... [{100 * k // len(pages):3d}%] {page}")
        whole.write(target)
    return target


def _heading(page: str) -> str:
    text = (HTML / f"{page}.html").read_text(encoding="utf-8")
    found = re.search(r"<title>(.*?)(?: — .*)?</title>", text, re.S)
    return html.unescape(found[1]).strip() if found else page
