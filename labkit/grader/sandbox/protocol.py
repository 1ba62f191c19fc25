"""Lines of JSON over a socket, with a limit on their length and on the time they take."""

from __future__ import annotations

import json
import select
import socket
import time
from typing import Any

MOST = 2**25
"""The longest line, in bytes, where nobody asks for less."""


class Disconnected(Exception):
    """The other side closed its end."""


class Timeout(Exception):
    """Nothing came in time."""


class MessageTooLarge(Exception):
    """The other side sent more than is allowed, or something that is not JSON."""


class Connection:
    """One end of a conversation in lines of JSON.

    It trusts nothing that comes in: what is too long, too late, or not a JSON object ends in one of
    the exceptions above.
    """

    def __init__(self, end: socket.socket) -> None:
        self.socket = end
        self._waiting = bytearray()

    def send(self, message: dict[str, Any], seconds: float = 30.0) -> None:
        """Write one message.

        Raises:
            Disconnected: Nobody reads, or nobody has read for that long.
        """
        self.socket.settimeout(seconds)
        try:
            self.socket.sendall(json.dumps(message, separators=(",", ":")).encode() + b"\n")
        except OSError as error:
            raise Disconnected(str(error)) from None

    def read(
        self, seconds: float | None = None, most: int = MOST, values: int = MOST
    ) -> dict[str, Any]:
        """Read one message.

        Args:
            seconds: How long to wait; None waits for ever.
            most: The longest line, in bytes.
            values: How many numbers, texts, lists and tables it may have in all.

        Raises:
            Disconnected: There is no other side any more.
            Timeout: It took longer than ``seconds``.
            MessageTooLarge: It is more than that, or not a JSON object.
        """
        data = self._read_line(seconds, most)
        if data.count(b",") + data.count(b"[") + data.count(b"{") > values:
            raise MessageTooLarge(f"more than {values:,} values came back")
        try:
            message = json.loads(data)
        except (ValueError, RecursionError):
            raise MessageTooLarge("what came back is not JSON") from None
        if not isinstance(message, dict):
            raise MessageTooLarge("what came back is not a message")
        return message

    def _read_line(self, seconds: float | None, most: int) -> bytes:
        """One line without its end; raises as `read` does."""
        until = None if seconds is None else time.monotonic() + seconds
        start = 0
        while (found := self._waiting.find(b"\n", start)) < 0:
            start = len(self._waiting)
            if start > most:
                break
            left = None if until is None else until - time.monotonic()
            if left is not None and (
                left <= 0 or not select.select([self.socket], [], [], left)[0]
            ):
                raise Timeout("nothing came in time")
            self.socket.settimeout(None)
            try:
                piece = self.socket.recv(65536)
            except OSError as error:
                raise Disconnected(str(error)) from None
            if not piece:
                raise Disconnected("the other side is gone")
            self._waiting += piece
        if not 0 <= found <= most:
            raise MessageTooLarge(f"more than {most // 1000:,} kB came back")
        line = bytes(self._waiting[:found])
        del self._waiting[: found + 1]
        return line

    def close(self) -> None:
        """Close this end."""
        self.socket.close()
