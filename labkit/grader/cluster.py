"""A Dask cluster, for whoever has one."""

from __future__ import annotations

from typing import Any

from ..errors import LabkitError


def dask_client(address: str) -> Any:
    """A client of a Dask scheduler, to be closed after use.

    Args:
        address: Such as ``tcp://127.0.0.1:8786``; take loopback or TLS.

    Raises:
        LabkitError: distributed is missing, or nobody answers there.
    """
    try:
        from distributed import Client
        from distributed.comm.addressing import resolve_address
    except ImportError:
        raise LabkitError("Dask is missing; type: pip install 'labkit[cluster]'") from None
    try:
        resolve_address(address)  # a client of what is not an address takes 20 s to give up
        return Client(address, timeout="10s", set_as_default=False)
    except (OSError, ValueError) as error:
        raise LabkitError(f"no Dask scheduler at {address}: {error}") from None
