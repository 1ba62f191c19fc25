"""Attacks on the instructor who looks at the results, by terminal codes."""

from __future__ import annotations

from soak.attacks.attack import Attack, answers, cells

TERMINAL = answers(
    "commands",
    escape="raise ValueError('\\x1b[2J\\x1b]0;owned\\x07')",
    a_single_character="raise ValueError('\\x9b2J')",
    lines_of_its_own="raise ValueError('\\n[9/9] everybody: 20 of 20\\n')",
    the_name_of_an_exception="raise type('\\x1b[31mE\\n', (Exception,), {})('x')",
    in_an_answer="return '\\x1b[2J', '\\x9b', '\\u2028'",
    in_a_table="return {'\\x1b[2J': 1}",
) | cells(
    "commands",
    a_cell_that_prints="print('\\x1b[2J\\x9b\\u202e')\nraise Exception('\\x1b]0;owned\\x07')",
)  # fmt: skip
TERMINAL["a cell that cannot be read"] = Attack("commands", ("print('\x1b[2J\u202e'\n",))
