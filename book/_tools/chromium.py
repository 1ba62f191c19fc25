"""Find the Chromium that prints, tests and measures the book: python book/_tools/chromium.py."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

NAMES = ("chromium", "google-chrome")


def program() -> str:
    """The path of the system's Chromium, or else of the one that Playwright installed.

    Ubuntu's Chromium is ignored: it is a snap, which cannot see our files or be controlled.

    Raises:
        SystemExit: There is no Chromium; the message has the commands that install it.
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
