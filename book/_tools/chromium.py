"""Which Chromium prints the book, tests and measures its pages: python book/_tools/chromium.py."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

NAMES = ("chromium", "google-chrome")


def program() -> str:
    """Path of the system's Chromium, else of the one that Playwright brought.

    Ubuntu's is a snap, which neither sees our files nor can be driven, so it does not count.

    Raises:
        SystemExit: There is none; the lines that bring one.
    """
    brought = Path(os.environ.get("PLAYWRIGHT_BROWSERS_PATH", "~/.cache/ms-playwright"))
    found = [path for name in NAMES if (path := shutil.which(name)) and "/snap/" not in path]
    found += map(str, brought.expanduser().glob("chromium-*/chrome-linux*/chrome"))
    if not found:
        raise SystemExit(
            "Chromium is missing. Debian: sudo apt-get install -y chromium; "
            "Ubuntu: .venv/bin/playwright install --with-deps chromium"
        )
    return found[0]


if __name__ == "__main__":
    print(program())
