"""The notation: a table of symbols that the book prints and the docstrings use.

A test reads every public docstring and compares its shapes and units with this table.
"""

from __future__ import annotations

from typing import NamedTuple


class Symbol(NamedTuple):
    """One name of the lab.

    Attributes:
        code: The name in code.
        latex: The symbol in formulas.
        meaning: The meaning of the symbol.
        shape: The array's shape as in docstrings; empty if the symbol is not a single array.
        unit: The unit as in docstrings; empty if there is none.
    """

    code: str
    latex: str
    meaning: str
    shape: str = ""
    unit: str = ""


SYMBOLS = (
    Symbol("t", "t", "time", "", "s"),
    Symbol("s", "s", "place along a path, from 0 to 1"),
    Symbol("q", "q", "joint angles; Baxter's are s0 s1 e0 e1 w0 w1 w2", "(n,)", "rad"),
    Symbol("dq", r"\dot q", "joint speeds", "(n,)", "rad/s"),
    Symbol("ddq", r"\ddot q", "joint accelerations", "(n,)", "rad/s^2"),
    Symbol("tau", r"\tau", "motor torques", "(n,)", "N m"),
    Symbol("e", r"e = x_d - x", "error, target minus actual, always"),
    Symbol("T_wt", "T_{wt}", "pose of the tip in the world; p_w = T_wt p_t", "(4, 4)", ""),
    Symbol("T_wd", "T_{wd}", "desired pose of the tip in the world", "(4, 4)", ""),
    Symbol("T_ab", "T_{ab}", "pose of frame b in frame a; p_a = T_ab p_b", "(4, 4)", ""),
    Symbol("R_wt", "R_{wt}", "orientation of the tip in the world", "(3, 3)", ""),
    Symbol("R_wd", "R_{wd}", "desired orientation of the tip in the world", "(3, 3)", ""),
    Symbol("V", "V = (v, \\omega)", "twist: linear part first, then angular", "(6,)", ""),
    Symbol("J", "J(q)", "tip Jacobian in world axes, (v, w) rows", "(6, n)", ""),
    Symbol("M", "M(q)", "mass matrix", "(n, n)", "kg m^2"),
    Symbol("C", r"C(q, \dot q)", "Coriolis matrix", "(n, n)", "kg m^2/s"),
    Symbol("g", "g(q)", "torque that holds the arm against gravity", "(n,)", "N m"),
    Symbol(
        "Lambda", r"\Lambda(q)", "inertia felt at the tip, in kg, kg m and kg m^2", "(6, 6)", ""
    ),
    Symbol("Jplus", "J^+", "pseudo-inverse of the Jacobian"),
    Symbol("sigma", r"\sigma", "singular value of the Jacobian; of noise, the standard deviation"),
    Symbol("lambda", r"\lambda", "damping of the damped inverse"),
    Symbol("omega", r"\omega", "angular velocity of a body, or frequency", "", "rad/s"),
    Symbol("F", "F = (f, m)", "wrench at the tip: force, then moment"),
    Symbol("K", "K", "stiffness at the tip", "", "N/m"),
    Symbol("D", "D", "damping at the tip", "", "N s/m"),
    Symbol("T", "T", "duration, or sampling time", "", "s"),
    Symbol("Kp", "K_p", "gain on the error"),
    Symbol("Kd", "K_d", "gain on the error's rate"),
)
"""The symbols in the order of the conventions page."""

ERRORS = (
    Symbol("e_q", "e_q = q_d - q", "joint error", "(n,)", "rad"),
    Symbol("e_p", "e_p = p_d - p", "position error of the tip, world axes", "(3,)", "m"),
    Symbol(
        "e_o",
        r"e_o = \log(R_{wd} R_{wt}^T)^\vee",
        "orientation error of the tip, world axes",
        "(3,)",
        "rad",
    ),
)
"""The error, target minus actual, in its three forms."""
