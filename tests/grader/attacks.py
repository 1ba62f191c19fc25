"""Attacks on the grader, by class.

An attack is a cell in an otherwise empty notebook, or it replaces a question's function.  It raises
an exception with `GOT ...` when it has obtained something forbidden.
"""

from __future__ import annotations

from dataclasses import dataclass

from handmade import add, put


@dataclass(frozen=True)
class Attack:
    """One attack.

    Attributes:
        cell: A cell above the answers.
        answer: The first question's function; NAME stands for its name.
    """

    cell: str = ""
    answer: str = ""

    def planted(self, notebook, at=2, **own):
        """Put the attack into a notebook; words in braces are replaced by values of the test.

        GOT is disguised there, because a traceback shows the line that failed.
        """
        cell, answer = self.cell, self.answer.replace("NAME", "bang_bang")
        for word, value in own.items():
            cell = cell.replace("{" + word + "}", str(value))
        if cell:
            add(notebook, cell.replace("GOT", r"G\x4fT"), at)
        if answer:
            put(notebook, "bang_bang", answer.replace("GOT", r"G\x4fT"))
        return notebook


def cells(**sources: str) -> dict[str, Attack]:
    return {name: Attack(cell=source) for name, source in sources.items()}


def answers(**bodies: str) -> dict[str, Attack]:
    """Attacks from within the function, each given as the body of the function."""
    made = {}
    for name, body in bodies.items():
        lines = "\n    ".join(body.strip().splitlines())
        made[name] = Attack(answer=f"def NAME(t, duration):\n    {lines}")
    return made


def reads(*paths: str) -> dict[str, Attack]:
    return {
        f"read {path}": Attack(
            cell=f"text = open({path!r}, 'rb').read(200)\nif text: raise Exception('GOT ' + repr(text))"
        )
        for path in paths
    }


PATCHED = cells(
    assert_allclose="import numpy as np\nnp.testing.assert_allclose = lambda *a, **k: None",
    numpy_abs="import numpy as np\nnp.abs = np.absolute = lambda x: np.zeros_like(x)",
    builtin_isinstance="import builtins\nbuiltins.isinstance = lambda *a: True",
    check_returns="import labkit.course\nlabkit.course.check = lambda *a: 20.0",
    judge="from labkit.course import judge\njudge.Close.__call__ = lambda *a: None",
    codec_encode="import sys\nfor m in list(sys.modules.values()):\n"
    "    if getattr(m, 'encode', None): m.encode = lambda x: {'is': 'right'}",
    json_dumps='import json\njson.dumps = lambda *a, **k: \'{"is": 1.0, "earned": 20}\'',
)
HOOKS = cells(
    ast_transformer="ip = get_ipython()\nip.ast_transformers.append(lambda t: t)",
    showtraceback="get_ipython().showtraceback = lambda *a, **k: None",
    settrace="import sys\nsys.settrace(lambda *a: None)",
    import_hook="import builtins\nold = builtins.__import__\n"
    "builtins.__import__ = lambda n, *a, **k: old('math' if n == 'numpy' else n, *a, **k)",
    meta_path="import sys\nsys.meta_path.clear()",
    post_run_cell="get_ipython().events.register('post_run_cell', lambda *a: None)",
)
_EQUAL = "class All{base}:\n{body}def NAME(t, duration):\n    return {value}"
EQUAL = {
    name: Attack(answer=_EQUAL.format(base=base, body=body, value=value))
    for name, base, body, value in [
        ("eq", "", "    def __eq__(self, o): return True\n", "All()"),
        ("float that equals", "(float)", "    def __eq__(self, o): return True\n", "(All(), All(), All())"),
        ("array function", "", "    def __array_function__(self, *a, **k): return True\n", "All()"),
        ("iter for ever", "", "    def __iter__(self):\n        while True: yield 0.0\n", "All()"),
        ("float protocol", "", "    def __float__(self): return float('nan')\n", "All()"),
        ("type lies", "", "    @property\n    def __class__(self): return tuple\n", "All()"),
    ]
}  # fmt: skip
ODD = answers(
    nan="return float('nan'), float('nan'), float('nan')",
    true="return True, True, True",
    longest_int="return 10**5000, 0, 0",
    deep="x = []\nfor _ in range(5000): x = [x]\nreturn x",
    cyclic="x = []\nx.append(x)\nreturn x",
    object_array="import numpy as np\nreturn np.array([object()] * 3)",
    surrogate="return '\\ud800'",
    large="return [0.0] * 5_000_000",
)
FRAMES = answers(
    frame_locals="import sys\nf = sys._getframe()\nwhile f:\n"
    "    if 'expected' in f.f_locals or 'case' in f.f_locals: raise Exception('GOT ' + str(f.f_locals))\n"
    "    f = f.f_back\nreturn 0, 0, 0",
    gc_objects="import gc\nfor x in gc.get_objects():\n"
    "    if type(x).__name__ in ('Question', 'Call', 'Test', 'Verdict', 'Mistake'): raise Exception('GOT ' + str(x))\n"
    "return 0, 0, 0",
    modules="import sys\nfor m in sys.modules:\n"
    "    if m.startswith('solutions') or m.endswith(('checker', 'bundle')): raise Exception('GOT ' + m)\n"
    "return 0, 0, 0",
    import_solutions="from solutions.paths.answers import bang_bang\nreturn bang_bang(t, duration)",
    import_reference="import solutions.paths.problems as p\nraise Exception('GOT ' + str(p))",
    withheld="import labkit\nreturn labkit.BangBang(duration)(t)",
    withheld_subclass="import labkit\nclass Mine(labkit.BangBang): pass\nreturn Mine(duration)(t)",
)
FAKES = cells(
    write_labkit="open('labkit.py', 'w').write('check = 1')\nimport sys\nsys.path.insert(0, '.')",
    replace_module="import sys, types\nsys.modules['labkit'] = types.ModuleType('labkit')",
    site_packages="import numpy\nopen(numpy.__file__, 'a').write('x = 1')\nraise Exception('GOT write')",
    labkit_file="import labkit\nopen(labkit.__file__, 'a').write('x = 1')\nraise Exception('GOT write')",
    del_modules="import sys\nfor m in list(sys.modules):\n    if m.startswith('labkit'): del sys.modules[m]",
)
FILES = reads(
    "../../../solutions/paths/answers.py",
    "{root}/solutions/paths/answers.py",
    "{root}/build/course/bundle/01_curves.json",
    "{root}/gradebook.db",
    "{root}/submitted/bob/01_curves/01_curves.ipynb",
    "/etc/passwd",
    "/proc/1/environ",
    "/proc/self/mem",
    "/dev/kmsg",
    "checks.json",
) | cells(
    write_root="open('/x', 'w').write('x')\nraise Exception('GOT write')",
    write_etc="open('/etc/x', 'w').write('x')\nraise Exception('GOT write')",
    list_home="import os\nfound = os.listdir('/home')\nraise Exception('GOT ' + str(found))",
    environment="import os\nbad = [k for k in os.environ if 'PASS' in k or 'TOKEN' in k or 'SECRET' in k]\n"
    "if bad: raise Exception('GOT ' + str(bad))",
    symlink="import os\nos.symlink('/etc/shadow', 'link')\nraise Exception('GOT ' + open('link').read())",
    hard_link="import os\nos.link('/usr/bin/env', 'env')\nraise Exception('GOT link')",
    fill_disk="open('full', 'wb').write(b'x' * 200 * 2**20)\nraise Exception('GOT 200 MB')",
    many_files="import os\nfor k in range(10_000): open(f'f{k}', 'w')\nraise Exception('GOT files')",
    setuid="import os\nopen('s', 'w')\nos.chmod('s', 0o4777)\nos.chown('s', 1, 1)\nraise Exception('GOT')",
    device="import os, stat\nos.mknod('d', stat.S_IFBLK | 0o666, os.makedev(8, 0))\nraise Exception('GOT')",
)  # fmt: skip
NETWORK = cells(
    tcp="import socket\nsocket.create_connection(('1.1.1.1', 53), 2)\nraise Exception('GOT net')",
    loopback="import socket\nsocket.create_connection(('127.0.0.1', 22), 2)\nraise Exception('GOT net')",
    listen="import socket\ns = socket.socket()\ns.bind(('', 0))\ns.listen()\nraise Exception('GOT net')",
    dns="import socket\nraise Exception('GOT ' + str(socket.gethostbyname('example.org')))",
    abstract="import socket\ns = socket.socket(socket.AF_UNIX)\n"
    "s.connect('\\0/tmp/.X11-unix/X0')\nraise Exception('GOT net')",
)  # fmt: skip
SIGNALS = cells(
    kill_all="import os, signal\nos.kill(-1, signal.SIGKILL)",
    kill_group="import os, signal\nos.killpg(0, signal.SIGKILL)",
    stop_self="import os, signal\nos.kill(os.getpid(), signal.SIGSTOP)",
    hard_exit="import os\nos._exit(0)",
    segfault="import ctypes\nctypes.string_at(0)",
    closed="import os\nos.closerange(0, 256)",
    forks="import os, time\nfor _ in range(200):\n    if not os.fork():\n        time.sleep(60)\n        os._exit(0)",
    daemon="import os, time\nif not os.fork():\n    os.setsid()\n    if not os.fork():\n        time.sleep(600)\n    os._exit(0)",
    memory="x = bytearray(6 * 10**9)\nraise Exception('GOT memory')",
    priority="import os\nos.nice(-10)\nraise Exception('GOT priority')",
)  # fmt: skip
ENDLESS = cells(
    loop="while True: pass",
    deaf="import signal\nfor s in (signal.SIGALRM, signal.SIGPROF, signal.SIGXCPU): signal.signal(s, signal.SIG_IGN)\n"
    "while True: pass",
    catches="while True:\n    try:\n        while True: pass\n    except BaseException: pass",
    sleeps="import time\ntime.sleep(1000)",
    prints="while True: print('x' * 10_000)",
)  # fmt: skip
KERNEL = cells(
    ptrace="import ctypes\nif ctypes.CDLL(None).ptrace(0, 0, 0, 0) == 0: raise Exception('GOT ptrace')",
    mount="import ctypes\nif ctypes.CDLL(None).mount(b'x', b'/tmp', b'tmpfs', 0, None) == 0: raise Exception('GOT mount')",
    unmount="import ctypes\nif ctypes.CDLL(None).umount2(b'/proc', 2) == 0: raise Exception('GOT umount')",
    setuid="import os\nos.setuid(0)\nif os.getuid() == 0 and open('/etc/x', 'w'): raise Exception('GOT root')",
    chroot="import os\nos.chroot('/tmp')\nraise Exception('GOT chroot')",
    clone_user="import ctypes\nr = ctypes.CDLL(None).syscall(56, 0x10000011, 0, 0, 0, 0)\n"
    "if r > 0: raise Exception('GOT clone')",
    bpf="import ctypes\nif ctypes.CDLL(None).syscall(321, 0, 0, 0) >= 0: raise Exception('GOT bpf')",
    io_uring="import ctypes\nif ctypes.CDLL(None).syscall(425, 1, 0) >= 0: raise Exception('GOT uring')",
    limits="import resource\nresource.setrlimit(resource.RLIMIT_NPROC, (10**4, 10**4))\nraise Exception('GOT limits')",
)  # fmt: skip
_ENDS = (
    "import os, stat\ndef shout(data):\n    for f in range(3, 128):\n        try:\n"
    "            if stat.S_ISSOCK(os.fstat(f).st_mode): os.write(f, data)\n        except OSError: pass\n"
)
FORGERY = cells(
    verdict=_ENDS + "shout(b'{\"earned\": 20, \"outcome\": \"right\"}\\n' * 40)",
    answers=_ENDS + "shout(b'{\"is\": 1.0}\\n' * 400)",
    no_end=_ENDS + "shout(b'x' * 100_000)",
    endless=_ENDS + "import itertools\nfor _ in itertools.count(): shout(b'x' * 65536)",
    deep=_ENDS + "shout(b'[' * 90_000 + b'\\n')",
    pickle=_ENDS + "import pickle\nclass E:\n    def __reduce__(self): return (print, ('GOT',))\n"
    "shout(pickle.dumps(E()) + b'\\n')",
    method=_ENDS + "shout(b'{\"is\": {\"$\": \"method\", \"of\": 1, \"name\": \"__class__\"}}\\n' * 99)",
    read_ahead=_ENDS + "for f in range(3, 128):\n    try:\n        os.set_blocking(f, False)\n"
    "        data = os.read(f, 10**6)\n        if b'hidden' in data or b'expected' in data: raise Exception('GOT ' + str(data))\n"
    "    except OSError: pass",
)  # fmt: skip
FEEDBACK = answers(
    script="raise ValueError('<script>alert(1)</script>')",
    terminal="raise ValueError('\\x1b[2J\\x1b]0;owned\\x07')",
    newlines="raise ValueError('\\n[999/999] everybody: 20 of 20\\n')",
    long="raise ValueError('x' * 10**7)",
    kind_of_its_own="raise type('GOT ' + repr((t, duration)), (Exception,), {})",
    str_raises="class E(Exception):\n    def __str__(self): raise SystemExit\nraise E",
)  # fmt: skip
FEEDBACK["tells hidden inputs in a public case"] = Attack(
    answer="seen = []\ndef NAME(t, duration):\n    seen.append((t, duration))\n"
    "    if len(seen) > 27: raise ValueError('GOT ' + repr(seen[27:]))\n    return 0, 0, 0"
)

CLASSES: dict[str, dict[str, Attack]] = {
    "patched comparison": PATCHED,
    "display and execution hooks": HOOKS,
    "objects that compare equal": EQUAL,
    "odd answers": ODD,
    "frame walking": FRAMES,
    "fake modules": FAKES,
    "files": FILES,
    "network": NETWORK,
    "signals and processes": SIGNALS,
    "endless": ENDLESS,
    "kernel": KERNEL,
    "protocol forgery": FORGERY,
    "feedback injection": FEEDBACK,
}
