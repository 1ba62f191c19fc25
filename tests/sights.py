"""Things that the tests of cameras put in front of them."""

from dataclasses import dataclass, replace

import numpy as np

from labkit.tags.drawing import box


@dataclass(frozen=True, eq=False)
class Block:
    """A plain box: half the lengths of its edges [m], its colour, its pose in the world."""

    half: tuple
    colour: tuple
    T: np.ndarray

    def surface(self):
        """The six faces of the box."""
        return box(self.half, self.colour).moved(self.T)


def resized(lens, k):
    """The same lens with a sensor that has k times more pixels along each side."""
    return replace(
        lens,
        width=round(lens.width * k),
        height=round(lens.height * k),
        fx=lens.fx * k,
        fy=lens.fy * k,
        cx=(lens.cx + 0.5) * k - 0.5,  # the corner of the picture is at -0.5
        cy=(lens.cy + 0.5) * k - 0.5,
    )
