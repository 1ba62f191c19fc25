"""Attacks on the instructor who looks at the results, by terminal codes and by markup."""

from __future__ import annotations

from soak.attacks.attack import Attack, answers, cells

TERMINAL = answers(
    "commands",
    escape="raise ValueError('\\x1b[2J\\x1b]0;owned\\x07')",
    a_single_character="raise ValueError('\\x9b2J')",
    lines_of_its_own="raise ValueError('\\n[9/9] everybody: 20 of 20\\n')",
    back_to_the_start="raise ValueError('\\rmallory: 20 of 20')",
    the_other_direction="raise ValueError('\\u202e02 fo 02')",
    a_link="raise ValueError('\\x1b]8;;http://x\\x1b\\\\marks\\x1b]8;;\\x1b\\\\')",
    the_name_of_an_exception="raise type('\\x1b[31mE\\n', (Exception,), {})('x')",
    in_an_answer="return '\\x1b[2J', '\\x9b', '\\u2028'",
    in_a_table="return {'\\x1b[2J': 1}",
) | cells(
    "commands",
    a_cell_that_prints="print('\\x1b[2J\\x9b\\u202e')\nraise Exception('\\x1b]0;owned\\x07')",
    a_name_in_a_cell="exec(compile('raise Exception', '\\x1b[2J', 'exec'))",
)  # fmt: skip
TERMINAL["a cell that cannot be read"] = Attack("commands", ("print('\x1b[2J\u202e'\n",))

MARKUP = {
    "script": "<script>window.GOT = 1</script>",
    "picture": "<img src=x onerror=\"window.GOT=1\">",
    "drawing": "<svg><g onload=\"window.GOT=1\"></g></svg>",
    "drawing with a script": "<svg><script>window.GOT = 1</script></svg>",
    "frame": "<iframe srcdoc=\"<script>parent.GOT=1</script>\"></iframe>",
    "link": "<a href=\"javascript:window.GOT=1\">marks</a>",
    "link in markdown": "[marks](javascript:window.GOT=1)",
    "link by reference": "[marks][a]\n\n[a]: javascript:window.GOT=1",
    "link with white space": "<a href=\"java&#10;script:window.GOT=1\">marks</a>",
    "form": "<form action=\"http://x\"><button formaction=\"javascript:window.GOT=1\">Save</button></form>",
    "style": "<style>body { background: url(http://x/?got) }</style>",
    "another place": "<meta http-equiv=refresh content=\"0;url=http://x\">",
    "another base": "<base href=\"http://x/\">",
    "object": "<object data=\"javascript:window.GOT=1\"></object><embed src=\"javascript:window.GOT=1\">",
    "details": "<details open ontoggle=\"window.GOT=1\">x</details>",
    "focus": "<input autofocus onfocus=\"window.GOT=1\">",
    "a broken comment": "<!--><script>window.GOT=1</script>-->",
    "mathematics": "<math><mtext><table><mglyph><style><img src=x onerror=\"window.GOT=1\"></style></mglyph></table></mtext></math>",
    "a title that ends": "</title></textarea></style><script>window.GOT=1</script>",
    "a heading": "# <script>window.GOT=1</script>",
    "a table in markdown": "| a |\n|---|\n| <img src=x onerror=\"window.GOT=1\"> |",
    "code that ends": "```\n</code></pre><script>window.GOT=1</script>\n```\n</pre><script>window.GOT=1</script>",
}  # fmt: skip
"""Text cells, each of which runs code where it is shown without escaping."""
