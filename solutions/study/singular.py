r"""Damp an inverse near a singularity, and warn once.

.. math:: J^+ = J^T (J J^T + \lambda^2 I)^{-1}, \qquad
   \lambda^2 = \left(1 - (\sigma_{min} / \epsilon)^2\right) \lambda^2_{max}
   \ \text{where } \sigma_{min} < \epsilon, \text{ else } 0

Nakamura & Hanafusa 1986; Siciliano, *Robotics: Modelling, Planning and Control*, section 3.5.2.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field

import numpy as np

from labkit.errors import LabkitWarning
from labkit.shapes import Array


@dataclass
class Watch:
    """Measures how close a singularity is, and warns the first time.

    Attributes:
        threshold: The smallest singular value of the tip Jacobian below which damping begins.
        warned: Whether it has warned.
    """

    threshold: float = 0.03
    warned: bool = field(default=False, repr=False)

    def share(self, J: Array) -> float:
        """The share of the largest damping to use, 0 away from singularities and 1 at one.

        Args:
            J: Tip Jacobian, shape (6, n).
        """
        sigma = np.linalg.svd(J, compute_uv=False)
        if sigma[-1] >= self.threshold:
            return 0.0
        if not self.warned:
            self.warned = True
            warnings.warn(
                f"near a singularity: manipulability {np.prod(sigma):.2g}, smallest singular value "
                f"{sigma[-1]:.2g} below {self.threshold:g}; the inverse is damped, so the tip "
                "will leave its path",
                LabkitWarning,
                stacklevel=3,
            )
        return float(1.0 - (sigma[-1] / self.threshold) ** 2)


def damped_inverse(J: Array, damping: float) -> Array:
    """The damped pseudo-inverse of a wide matrix.

    Args:
        J: Shape (m, n), m <= n.
        damping: The damping, lambda squared; 0 gives the pseudo-inverse.

    Returns:
        Shape (n, m).
    """
    A = J @ J.T
    A.flat[:: len(A) + 1] += damping
    return np.asarray(np.linalg.solve(A, J).T)
