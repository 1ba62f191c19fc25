"""The number of sentences of the book that stop its build if their data are wrong."""

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parents[2] / "book/_tools"))


def measure():
    """Numbers of sentences with a number or a comparison, and of those that wrong data stop."""
    import book_claims

    found = book_claims.count(book_claims.noted())
    return {name: found[name] for name in ("book_claims", "book_claims_caught")}
