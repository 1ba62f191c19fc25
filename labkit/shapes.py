"""Convert arguments to the arrays that the mathematics needs, or say why that is impossible."""

from __future__ import annotations

from math import isfinite
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import NotFinite, OutOfRange, ShapeError, TypeMismatch

Array = NDArray[np.float64]
FLOAT = np.dtype(np.float64)


def as_array(x: Any, shape: tuple[int, ...], name: str) -> Array:
    """Read ``x`` as a finite float array of exactly this shape.

    Nothing is broadcast, reshaped or squeezed: a (7, 1) column is not a vector of 7.

    Args:
        x: Anything NumPy reads as an array of numbers.  It is not modified.
        shape: The shape it must have.
        name: What to call it in the sentence, if it does not fit.

    Returns:
        ``x`` itself if it already fits, otherwise a float64 copy; shape ``shape``.

    Raises:
        TypeMismatch: ``x`` does not consist of real numbers.
        ShapeError: The shape differs.
        NotFinite: An entry is NaN or infinite.
    """
    a: Array = x
    if type(x) is not np.ndarray or x.dtype != FLOAT:
        a = _converted(x, shape, name)
    if a.shape != shape:
        raise ShapeError(name, shape, a.shape)
    if not isfinite(np.vdot(a, a)) and not np.isfinite(a).all():
        at = tuple(np.argwhere(~np.isfinite(a))[0].tolist())
        what = f"holds {a[at]} at index {at if len(at) > 1 else at[0]}" if at else f"is {a}"
        raise NotFinite(
            f"{name} {what}; look for a division by zero, a square root or arccos out of its range"
        )
    return a


def as_vector(x: Any, n: int | None, name: str) -> Array:
    """Read ``x`` as ``n`` floats, in a read-only copy, so that the caller may change the original.

    Args:
        x: Anything NumPy reads as a vector.
        n: How many numbers; None takes as many as there are.
        name: What to call it in the sentence, if it does not fit.

    Returns:
        Shape (n,), read-only.
    """
    if n is None:
        shape = (x if isinstance(x, np.ndarray) else _converted(x, None, name)).shape
        if shape == ():
            raise TypeMismatch(f"{name} is {shown(x)}, expected a vector: a number for each joint")
        n = max(shape)
    return locked(np.array(as_array(x, (n,), name)))


def lock_vectors(owner: Any, n: int, *names: str) -> None:
    """Apply `as_vector` to fields of a frozen dataclass, with ``n`` numbers each."""
    for name in names:
        object.__setattr__(owner, name, as_vector(getattr(owner, name), n, name))


def as_numbers(x: Any, name: str) -> Array:
    """Read ``x`` as finite floats of any shape, in a copy.

    Args:
        x: Anything NumPy reads as an array of numbers.
        name: What to call it in the sentence, if it does not fit.

    Returns:
        A float64 array.
    """
    a = _converted(x, None, name)
    return as_array(a, a.shape, name)


def as_each(x: Any, n: int | None, name: str) -> Array:
    """Read ``x`` as ``n`` numbers; a single number is repeated.

    Args:
        x: A number, or a vector of ``n``.
        n: How many; None takes as many as there are.
        name: What to call them in the sentence, if they do not fit.

    Returns:
        Shape (n,), read-only; for a single number, shape (1,) if n is None.
    """
    numbers = as_numbers(x, name)
    return as_vector(np.full(n or 1, numbers) if numbers.ndim == 0 else numbers, n, name)


def as_gains(x: Any, n: int | None, name: str) -> Array:
    """Read ``x`` as ``n`` gains, as `as_each` does, and check that none is negative.

    Raises:
        ShapeError: There are too few or too many.
        OutOfRange: A gain is negative; with e = target - actual, every gain is at least 0.
    """
    gains = as_each(x, n, name)
    if gains.min(initial=0.0) < 0.0:
        i = int(np.flatnonzero(gains < 0.0)[0])
        raise OutOfRange(
            f"{name} is {gains[i]:g} at index {i}; a gain is at least 0, "
            "because the error is target minus actual"
        )
    return gains


def as_number(
    x: Any, name: str, *, above: float | None = None, least: float | None = None
) -> float:
    """Read ``x`` as one finite float.

    Args:
        x: A Python or NumPy number.
        name: What to call it in the sentence, if it does not fit.
        above: It must be greater than this.
        least: It must be at least this.

    Returns:
        The number.

    Raises:
        TypeMismatch: It is not a number.
        ShapeError: There are several.
        NotFinite: It is NaN or infinite.
        OutOfRange: It is too small.
    """
    value = float(as_array(x, (), name))
    if above is not None and not value > above:
        raise OutOfRange(f"{name} is {value:g}; it must be greater than {above:g}")
    if least is not None and not value >= least:
        raise OutOfRange(f"{name} is {value:g}; it must be at least {least:g}")
    return value


def as_random(seed: Any) -> np.random.Generator:
    """The random number generator of a seed.

    Args:
        seed: A whole number from 0 up, or an existing generator.

    Raises:
        TypeMismatch: ``seed`` is neither.
    """
    try:
        return np.random.default_rng(seed)
    except (TypeError, ValueError):
        raise TypeMismatch(f"seed is {shown(seed)}, expected a whole number from 0 up") from None


def locked(a: Array) -> Array:
    """The same array, made read-only."""
    a.setflags(write=False)
    return a


def _converted(x: Any, shape: tuple[int, ...] | None, name: str) -> Array:
    many = (
        "one real number"
        if shape == ()
        else f"{'' if shape is None else 'x'.join(map(str, shape)) + ' '}real numbers"
    )
    try:
        a = np.asarray(x)
    except ValueError:
        raise TypeMismatch(f"{name} has rows of different lengths, expected {many}") from None
    if a.dtype.kind not in "fiub":
        raise TypeMismatch(f"{name} is {shown(x)}, expected {many}")
    return a.astype(np.float64)


def shown(x: Any) -> str:
    """A value and its type, short enough for a message."""
    text = repr(x)
    return f"{text if len(text) < 40 else text[:37] + '...'} ({type(x).__name__})"
