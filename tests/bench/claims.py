"""How many sentences of the book stop its build when their data are wrong: `... claims`."""

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).parents[2] / "book/_tools"))


def measure():
    """Sentences with a number or a comparison, and those that wrong data stop."""
    import book_claims

    found = book_claims.count(book_claims.noted())
    return {name: found[name] for name in ("book_claims", "book_claims_caught")}
