"""JSON messages over a socket, one per line, with limits on their size and time; clean text."""

from __future__ import annotations

import json
import re
import select
import socket
import time
from typing import Any

MAX_BYTES = 2**25
"""The longest message, unless the caller sets a lower limit."""
_UNSAFE = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069\ufeff]")
_SURROGATE = re.compile("[\ud800-\udfff]")


def clean_text(text: str) -> str:
    """Make a text of several lines safe for every file, database and terminal.

    Lone surrogates, which UTF-8 cannot encode, become U+FFFD.  Control characters other than tab
    and newline are removed, such as the escape character, the marks that change the direction of
    writing, and the carriage return before a newline.
    """
    return _UNSAFE.sub("", _SURROGATE.sub("\ufffd", text))


def clean_line(text: str, most: int = 500) -> str:
    """Make a text one short, safe line, with each run of white space replaced by a space.

    Args:
        text: A sentence, or the name of a person or of a file.
        most: How many characters to keep.
    """
    return re.sub(r"\s+", " ", _UNSAFE.sub(" ", _SURROGATE.sub("\ufffd", text))).strip()[:most]


class ProtocolError(Exception):
    """No valid message arrived."""


class Disconnected(ProtocolError):
    """The other side closed its end of the socket."""


class Timeout(ProtocolError):
    """No message arrived in time."""


class BadMessage(ProtocolError):
    """The other side sent too much, or something that is not a message."""


class Connection:
    """One end of a socket; it does not trust what it receives."""

    def __init__(self, end: socket.socket) -> None:
        self.socket = end
        self._received = bytearray()

    def send(self, message: dict[str, Any], seconds: float = 30.0) -> None:
        """Write one message.

        Raises:
            Disconnected: The other side is gone, or has not read for that long.
        """
        self.socket.settimeout(seconds)
        try:
            self.socket.sendall(json.dumps(message, separators=(",", ":")).encode() + b"\n")
        except OSError as error:
            raise Disconnected(str(error)) from None

    def read(
        self, seconds: float = 1e6, max_bytes: int = MAX_BYTES, max_values: int = MAX_BYTES
    ) -> dict[str, Any]:
        """Read one message.

        Args:
            seconds: How long to wait.
            max_bytes: The size of the longest message.
            max_values: How many numbers, texts, lists and objects it may have in total.

        Raises:
            Disconnected: The other side has closed its end.
            Timeout: No message arrived within ``seconds``.
            BadMessage: The message is too large, or not a JSON object.
        """
        data = self._read_line(seconds, max_bytes)
        if data.count(b",") + data.count(b"[") + data.count(b"{") > max_values:
            raise BadMessage(f"more than {max_values:,} values came back")
        try:
            return dict(json.loads(data).items())
        except (ValueError, AttributeError, RecursionError):
            raise BadMessage("what came back is not a JSON object") from None

    def _read_line(self, seconds: float, max_bytes: int) -> bytes:
        """Read one line without its newline; raise as `read` does."""
        until = time.monotonic() + seconds
        start = 0
        while (end := self._received.find(b"\n", start)) < 0:
            start = len(self._received)
            if start > max_bytes:
                break
            left = max(0.0, until - time.monotonic())
            if not select.select([self.socket], [], [], left)[0]:
                raise Timeout("no message came in time")
            self.socket.settimeout(None)
            try:
                piece = self.socket.recv(65536)
            except OSError as error:
                raise Disconnected(str(error)) from None
            if not piece:
                raise Disconnected("the other side is gone")
            self._received += piece
        if not 0 <= end <= max_bytes:
            raise BadMessage(f"more than {max_bytes // 1000:,} kB came back")
        line = bytes(self._received[:end])
        del self._received[: end + 1]
        return line

    def close(self) -> None:
        """Close this end of the socket."""
        self.socket.close()
