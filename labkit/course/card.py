"""A message as a card in a notebook, with plain text as the alternative."""

from __future__ import annotations

import base64
import re
from collections.abc import Iterable
from html import escape
from io import BytesIO
from typing import Any

from .messages import PRINTED, Message, failures
from .verdict import Outcome

_BADGES = {
    Outcome.RIGHT: ("\N{CHECK MARK}", "#1a7f37"),
    Outcome.WRONG: ("\N{MULTIPLICATION SIGN}", "#9a5b00"),
    Outcome.ERROR: ("!", "#b3261e"),
}
"""The sign of an outcome, and a colour on which white letters are legible."""
_OTHER = ("\N{HORIZONTAL ELLIPSIS}", "#57606a")

_STYLE = """<style>
.lk-card { max-width: 46rem; margin: .2em 0; padding: .5em .9em; color: inherit; font-size: 1em;
  border: 1px solid var(--jp-border-color1, #8888); border-left: 5px solid var(--lk-badge);
  border-radius: 6px; overflow-wrap: anywhere; font-family: var(--jp-content-font-family,
  system-ui, sans-serif); line-height: 1.5; }
.lk-card :is(p, ul, details, pre) { margin: .35em 0; }
.lk-card b { color: #fff; background: var(--lk-badge); border-radius: 4px; padding: 0 .45em;
  margin-right: .4em; }
.lk-card summary { cursor: pointer; } .lk-card ul { padding-left: 1.4em; }
.lk-card p:first-child { font-weight: 600; }
.lk-card.lk-card.lk-card pre { white-space: pre-wrap; word-break: normal; }
.lk-card :is(code, pre) { color: inherit; font-size: .93em;
  font-family: var(--jp-code-font-family, ui-monospace, monospace); }
.lk-card img { max-width: 100%; background: #fff; }
</style>"""


def card(
    message: Message, outcome: Outcome, picture: tuple[bytes, str] | None = None
) -> dict[str, str]:
    """The representations of a message in a notebook: an HTML card, and plain text.

    Args:
        message: The message; its text is escaped.
        outcome: The outcome of the question.
        picture: A figure of the numbers, as the bytes of a PNG file, and its description.
    """
    sign, colour = _BADGES.get(outcome, _OTHER)
    failed = sum(test.startswith("[failed]") for test in message.tests)
    folded = [f"<ul>{''.join(f'<li>{_inline(test)}</li>' for test in message.tests)}</ul>"]
    folded += [_block(message.numbers)] if message.numbers else []
    if picture:
        data = base64.b64encode(picture[0]).decode()
        folded.append(f'<img alt="{escape(picture[1])}" src="data:image/png;base64,{data}">')
    parts = [f'<p><b aria-hidden="true">{sign}</b>{_inline(message.head)}</p>']
    parts += [f"<p>{_inline(line)}</p>" for line in message.helps]
    if message.tests:
        numbers = ", with the numbers" if message.numbers or picture else ""
        says = f"{failures(failed, len(message.tests))}. Show them{numbers}"
        parts.append(f"<details><summary>{says}</summary>{''.join(folded)}</details>")
    if message.printed:
        parts.append(f"<p>{PRINTED}</p>{_block(message.printed)}")
    hints = ""
    for k, hint in reversed([*enumerate(message.hints, start=1)]):  # each within the one before
        says = f"Hint {k} of {len(message.hints)}"
        hints = f"<details><summary>{says}</summary><p>{_inline(hint)}</p>{hints}</details>"
    parts.append(hints)
    names = "lk-card mathjax_ignore tex2jax_ignore"  # a dollar sign does not begin a formula
    page = f'<div class="{names}" style="--lk-badge: {colour}">{"".join(parts)}</div>{_STYLE}'
    return {"text/plain": str(message), "text/html": page}


def _inline(text: str) -> str:
    """Text as HTML, with code elements for what is between backticks."""
    return re.sub(r"`([^`]+)`", r"<code>\1</code>", escape(text))


def _block(lines: Iterable[str]) -> str:
    return f"<pre>{escape(chr(10).join(lines))}</pre>"


def picture(found: tuple[str, Any, Any]) -> tuple[bytes, str]:
    """A small figure of the answers that revealed a known mistake, and its description."""
    from .. import plotting

    drawn = BytesIO()  # a figure that pyplot did not make is not shown by the notebook itself
    plotting.answers(*found).savefig(drawn, format="png")
    call, expected, given = found
    words = f"{call}, number by number: expected {_list(expected)}; yours {_list(given)}."
    return drawn.getvalue(), words


def _list(numbers: Any) -> str:
    return ", ".join(f"{x:.3g}" for x in numbers)
