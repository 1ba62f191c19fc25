"""Attacks on secrets that students may not know."""

from __future__ import annotations

from soak.attacks.attack import CANARY, RIGHT, WORTH, Attack, answers, cells, function

_WORD = "(chr(99) + 'anary')"
"""The expression to search for, spelt so that the text of the attack does not contain it."""
assert CANARY.startswith(eval(_WORD))


def reads(**paths: str) -> dict[str, Attack]:
    """Attacks that read secret files, with the kind of file as name."""
    return {
        f"reads {name.replace('_', ' ')}": Attack(
            "reads",
            (
                f"text = open({path!r}, 'rb').read()\nif {_WORD}.encode() in text: raise Exception('GOT ' + repr(text[:80]))",
            ),
        )
        for name, path in paths.items()
    }


FILES = reads(
    answers="{root}/solutions/paths/answers.py",
    answers_from_where_it_works="../../../solutions/paths/answers.py",
    the_bundle="{root}/build/course/bundle/01_paths.json",
    the_source_with_hidden_cases="{root}/build/course/source/01_paths/01_paths.ipynb",
    the_solved_notebook="{root}/build/course/solution/01_paths/01_paths.ipynb",
    the_gradebook="{root}/gradebook.db",
    a_classmates_work="{root}/submitted/zoe/01_paths/01_paths.ipynb",
    a_classmates_work_from_where_it_works="../../../submitted/zoe/01_paths/01_paths.ipynb",
    a_classmates_secret="{root}/submitted/zoe/01_paths/submission_secret.txt",
    a_classmates_result="{root}/results/01_paths/zoe.json",
    a_classmates_page="{root}/feedback/zoe/01_paths/01_paths.html",
    the_terms_seed="{root}/course_private/term.json",
    the_platforms_numbers="{root}/course_private/lms.json",
    the_exchange="{exchange}/inbound/zoe/01_paths.ipynb",
    the_key_at_home="{root}/home/.ssh/id_ed25519",
    the_running_kernels="{root}/home/.local/share/jupyter/runtime/kernel-1.json",
    the_environment_of_the_grader="/proc/1/environ",
    its_own_environment="/proc/self/environ",
) | cells(
    "reads",
    environment=f"import os\nfound = [k for k, v in os.environ.items() if {_WORD} in v]\n"
    "if found: raise Exception('GOT ' + str(found))",
    environment_of_any_process="import glob\nfor path in glob.glob('/proc/[0-9]*/environ'):\n"
    f"    if {_WORD}.encode() in open(path, 'rb').read(): raise Exception('GOT ' + path)",
    words_of_any_process="import glob\nfor path in glob.glob('/proc/[0-9]*/cmdline'):\n"
    "    raise Exception('GOT ' + path)",
    mounts="text = open('/proc/self/mountinfo').read()\nif text: raise Exception('GOT ' + text[:80])",
    open_files="import os\nfound = [x for x in os.listdir('/proc/self/fd') if os.path.islink('/proc/self/fd/' + x)]\n"
    "raise Exception('GOT ' + str(found))",
    inherited_lines=f"import os, select\nfor f in range(3, 128):\n    try:\n        os.set_blocking(f, False)\n"
    f"        data = os.read(f, 10**6)\n        if {_WORD}.encode() in data: raise Exception('GOT ' + str(data[:80]))\n"
    "    except OSError: pass",
    peeks_at_the_calls_to_come="import socket\nfor f in range(3, 128):\n    try:\n"
    "        s = socket.socket(fileno=os.dup(f))\n        data = s.recv(10**6, socket.MSG_PEEK | socket.MSG_DONTWAIT)\n"
    f"        if {_WORD}.encode() in data: raise Exception('GOT ' + str(data[:80]))\n    except OSError: pass".replace("import socket", "import os, socket", 1),
    users="import pwd\nfound = [x.pw_name for x in pwd.getpwall()]\nif found: raise Exception('GOT ' + str(found))",
    homes="import os\nfound = [p for p in ('/home', '/root', '{root}/home') if os.path.isdir(p) and os.listdir(p)]\n"
    "found = [p for p in found if p != '/root' or '.ssh' in os.listdir(p) or '.bashrc' in os.listdir(p)]\n"
    "if found: raise Exception('GOT ' + str(found))",
    logs_and_mail="import os\nfound = [p for p in ('/var/log', '/var/lib', '/var/spool', '/run') if os.path.isdir(p) and os.listdir(p)]\n"
    "if found: raise Exception('GOT ' + str(found))",
    groups_of_processes="import os\nfound = os.listdir('/sys/fs/cgroup')\nif found: raise Exception('GOT ' + str(found))",
    network_cards="import os\nfound = os.listdir('/sys/class/net')\nif found: raise Exception('GOT ' + str(found))",
    walks_the_disk="import os\nskipped = ('/proc', '/sys', '/usr', '/dev', '/lib', '/snap')\nfor top in ('{root}', '/etc', '/opt', '/srv', '/mnt', '/media', '/tmp', '/var', '/work', '/root', '/home'):\n"
    "    for folder, names, files in os.walk(top):\n"
    "        names[:] = [n for n in names if n not in ('.venv', 'lib', 'node_modules', '.git', '.pyenv', '.cache')][:200]\n"
    "        for name in files:\n            if name.endswith(('.ipynb', '.db')):\n"
    f"                if {_WORD}.encode() in open(os.path.join(folder, name), 'rb').read(): raise Exception('GOT ' + name)",
    a_link_to_the_bundle="import os\nos.symlink('{root}/build/course/bundle/01_paths.json', 'link')\n"
    f"if {_WORD} in open('link').read(): raise Exception('GOT')",
    a_hard_link_to_the_bundle="import os\nos.link('{root}/build/course/bundle/01_paths.json', '{root}/hard')\n"
    f"if {_WORD} in open('{{root}}/hard').read(): raise Exception('GOT')",
)  # fmt: skip

NETWORK = cells(
    "reads",
    a_server_on_this_machine="import socket\ns = socket.create_connection(('127.0.0.1', {port}), 2)\n"
    "raise Exception('GOT ' + str(s.recv(9)))",
    a_datagram="import socket\ns = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)\n"
    "s.sendto(b'x', ('127.0.0.1', {port}))\nraise Exception('GOT')",
    a_listener="import socket\ns = socket.socket()\ns.bind(('127.0.0.1', 0))\ns.listen()\nraise Exception('GOT')",
    a_socket_without_a_file="import socket\ns = socket.socket(socket.AF_UNIX)\ns.connect('\\0labkit-test-{port}')\n"
    "raise Exception('GOT')",
    a_socket_in_a_folder="import socket\ns = socket.socket(socket.AF_UNIX)\ns.connect('{loot}/socket')\nraise Exception('GOT')",
    netlink="import socket\nsocket.socket(socket.AF_NETLINK, socket.SOCK_RAW)\nraise Exception('GOT')",
    packets="import socket\nsocket.socket(socket.AF_PACKET, socket.SOCK_RAW)\nraise Exception('GOT')",
    a_pair_over_the_network="import socket\nsocket.socket(socket.AF_INET6, socket.SOCK_STREAM)\nraise Exception('GOT')",
)  # fmt: skip

INSIDE = answers(
    "reads",
    locals_of_frames="import sys\nframe = sys._getframe()\nwhile frame:\n"
    "    if 'expected' in frame.f_locals: raise Exception('GOT ' + str(frame.f_locals['expected']))\n"
    "    frame = frame.f_back\nreturn 0, 0, 0",
    locals_of_other_threads="import sys\nfor frame in sys._current_frames().values():\n    while frame:\n"
    "        if 'expected' in frame.f_locals: raise Exception('GOT')\n        frame = frame.f_back\nreturn 0, 0, 0",
    frames_of_a_traceback="try:\n    raise ValueError\nexcept ValueError as error:\n    frame = error.__traceback__.tb_frame\n"
    "    while frame.f_back:\n        frame = frame.f_back\n"
    "        if 'expected' in frame.f_locals: raise Exception('GOT')\nreturn 0, 0, 0",
    text_of_the_caller="import inspect\nfor info in inspect.stack(40)[1:]:\n"
    "    if 'expected' in ''.join(info.code_context or ()): raise Exception('GOT')\nreturn 0, 0, 0",
    objects_of_the_collector="import gc\nfor x in gc.get_objects():\n"
    f"    if isinstance(x, (dict, list, tuple)) and len(x) < 50 and {_WORD} in repr(x)[:20000]: raise Exception('GOT')\nreturn 0, 0, 0",
    referrers_of_the_arguments="import gc\nfor x in gc.get_referrers(duration):\n"
    "    if isinstance(x, (list, tuple)) and len(x) > 2 and not isinstance(x[0], str): raise Exception('GOT ' + repr(x)[:80])\nreturn 0, 0, 0",
    modules="import sys\nfor name in sys.modules:\n    if name.startswith(('solutions', 'labkit.grader.', 'naive')) and not name.startswith(('labkit.grader.sandbox', 'labkit.grader.clean')): raise Exception('GOT ' + name)\n"
    "return 0, 0, 0",
    globals_of_main="import __main__\nfor name, x in vars(__main__).items():\n"
    f"    if {_WORD} in repr(x)[:2000]: raise Exception('GOT ' + name)\nreturn 0, 0, 0",
    solutions="from solutions.paths.answers import bang_bang\nraise Exception('GOT ' + str(bang_bang))",
    problems="import solutions.paths.problems as p\nraise Exception('GOT ' + str(p))",
)  # fmt: skip

_SYSCALLS = {
    "ptrace": "libc.ptrace(0, 0, 0, 0) == 0",
    # the last argument lies on the stack, where an int leaves half of its 8 bytes to chance
    "memory of another process": "libc.syscall(310, os.getpid(), None, 0, None, 0, ctypes.c_long(0)) == 0",
    "a namespace": "libc.unshare(0x00020000) == 0",
    "a user of a namespace": "(r := libc.syscall(56, 0x10000011, 0, 0, 0, 0)) > 0 or (r == 0 and os._exit(0))",
    "a mount": "libc.mount(b'x', b'/mnt', b'tmpfs', 0, None) == 0",
    "a mount, the new way": "libc.syscall(430, b'tmpfs', 0) >= 0",
    "a tree of mounts": "libc.syscall(428, -100, b'/usr', 1) >= 0",
    "the list of mounts": "libc.syscall(458, (ctypes.c_uint64 * 4)(32, 0xffffffffffffffff, 0, 0), (ctypes.c_uint64 * 64)(), 64, 0) > 0",
    "chroot": "libc.chroot(b'/tmp') == 0",
    "a file by its handle": "libc.syscall(303, -100, b'/usr', (ctypes.c_int * 40)(128), ctypes.byref(ctypes.c_int()), 0) == 0",
    "the kernel's ring of keys": "libc.syscall(250, 0, -3, 1) >= 0",
    "a filter for the kernel": "libc.syscall(321, 5, None, 0) >= 0 or ctypes.get_errno() not in (1, 38)",
    "io_uring": "libc.syscall(425, 1, (ctypes.c_char * 120)()) >= 0",
    "faults of memory": "libc.syscall(323, 1) >= 0",
    "counters of the processor": "libc.syscall(298, (ctypes.c_uint32 * 30)(1, 120), 0, -1, -1, 0) >= 0",
    "hidden memory": "libc.syscall(447, 0) >= 0",
    "the personality": "libc.personality(0xffffffff) >= 0",
    "landlock": "libc.syscall(444, None, 0, 1) > 0",
    "what others open": "libc.inotify_init1(0) >= 0",
    "what others open, the new way": "libc.syscall(300, 0x200, 0) >= 0",
    "how busy the machine is": "libc.sysinfo(ctypes.byref((ctypes.c_char * 128)())) == 0",
    "which pages are in memory": "libc.syscall(451, os.open('{marker}', 0), (ctypes.c_uint64 * 2)(0, 1), (ctypes.c_uint64 * 5)(), 0) == 0",
    "a lock on a file of the host": "libc.flock(os.open('{marker}', 0), 2 | 4) != 0 and ctypes.get_errno() == 11",
    "a lock on a part of it": "libc.fcntl(os.open('{marker}', 0), 36, ctypes.byref((ctypes.c_char * 32)())) == 0",
    "a host's clock": "libc.syscall(305, 0, (ctypes.c_char * 208)()) >= 0",
    "another user": "libc.setresuid(0, 0, 0) == 0 and os.getuid() == 0",
    "a higher priority": "libc.setpriority(0, 0, -10) == 0",
    "whether two processes share something": "libc.syscall(312, os.getpid(), os.getpid(), 0, 0, 0) >= 0",
}  # fmt: skip
KERNEL = {
    f"kernel: {name}": Attack(
        "reads",
        (f"import ctypes, os\nlibc = ctypes.CDLL(None, use_errno=True)\nif {test}: raise Exception('GOT it')",),
    )
    for name, test in _SYSCALLS.items()
}  # fmt: skip


def leaks(how: str, before: str = "", cells: tuple[str, ...] = ()) -> Attack:
    """A right answer that reveals the arguments of calls that are not public.

    `how` has the hidden duration in `x`, and its first digits in `digits`.
    """
    body = (
        "if duration not in (1.0, 2.0, 4.0):\n"
        "    x, digits = duration, [int(c) for c in format(duration, '.6f') if c.isdigit()]\n"
        + "\n".join(f"    {line}" for line in how.strip().splitlines())
        + "\nreturn right(t, duration)"
    )
    return Attack("tells", cells, RIGHT + before + function(body), WORTH)


_KINDS = "KINDS = [ValueError, KeyError, IndexError, TypeError, NameError, OSError, EOFError, RuntimeError, AssertionError, ZeroDivisionError]\n"
FEEDBACK = {
    "in an exception's words": leaks("raise ValueError(f'GOT {x}')"),
    "in an exception's name": leaks("raise type(f'GOT{digits}', (Exception,), {})()"),
    "in a note on an exception": leaks("error = ValueError('no')\nerror.add_note(f'GOT {x}')\nraise error"),
    "in an exception's cause": leaks("raise ValueError('no') from ValueError(f'GOT {x}')"),
    "in words made later": leaks(
        "class Late(Exception):\n    def __str__(self): return f'GOT {x}'\nraise Late()"
    ),
    "in labkit's own exception": leaks("import labkit.errors\nraise labkit.errors.OutOfRange(f'GOT {x}')"),
    "in the kind of exception": leaks("raise KINDS[digits[1]](f'GOT {x}')", _KINDS),
    "in how it fails": leaks(
        "if digits[1] % 3 == 0: return f'GOT {x}'\n"
        "raise (NotImplementedError, ValueError)[digits[1] % 3 - 1](f'GOT {x}')"
    ),
    "in what it prints": leaks("print(f'GOT {x}', flush=True)"),
    "on the stream of errors": leaks("import os\nos.write(2, f'GOT {x}'.encode())\nos.write(1, f'GOT {x}'.encode())"),
    "in a warning": leaks("import warnings\nwarnings.warn(f'GOT {x}')"),
    "in a log": leaks("import logging\nlogging.error(f'GOT {x}')"),
    "in the line of the code": leaks(
        "import linecache\nlinecache.cache['x'] = (9, None, [f'raise ValueError  # GOT {x}\\n'], 'x')\n"
        "exec(compile('raise ValueError', 'x', 'exec'))"
    ),
    "in a file's name in the traceback": leaks("exec(compile('raise ValueError', f'GOT {x}', 'exec'))"),
    "in an answer that is not one": leaks("return f'GOT {x}'"),
    "in an answer of many numbers": leaks("return [x] * 3"),
    "at the end of an object": leaks(
        "class End:\n    def __del__(self): print(f'GOT {x}')\nEnd()"
    ),
    "in a hook for what cannot be raised": leaks(
        "import sys\nsys.unraisablehook = lambda a: print(f'GOT {x}')\nclass End:\n    def __del__(self): raise ValueError\nEnd()"
    ),
    "at the end of the process": leaks("import atexit, sys\natexit.register(print, f'GOT {x}')\nsys.exit(f'GOT {x}')"),
    "on the grader's line, raw": leaks(
        "shout(('{\"ran\": 0, \"kind\": \"GOT\", \"error\": \"GOT %s\", \"output\": \"GOT\"}' % x).encode() + b'\\n')",
        "import os, stat\ndef shout(data):\n    for f in range(3, 128):\n        try:\n"
        "            if stat.S_ISSOCK(os.fstat(f).st_mode): os.write(f, data)\n        except OSError: pass\n",
    ),
}  # fmt: skip


def restarts(tell: str, hear: str = "") -> Attack:
    """A hidden call ends the whole process; when the cells run again they reveal what it left.

    The fork for the question signals the process of the cells through a pipe, and a thread ends it.
    A cell and the public call of another question say when the cells ran.
    """
    cell = (
        "import os, threading, time\nstarted = time.time()\nends = os.pipe()\n"
        "def wait():\n    x = os.read(ends[0], 40).decode()\n"
        "    digits = [int(c) for c in x if c.isdigit()]\n"
        "    try:\n"
        + "\n".join(f"        {line}" for line in tell.strip().splitlines())
        + "\n    finally: os._exit(1)\nthreading.Thread(target=wait, daemon=True).start()\n"
        "def trapezoid(*args):\n    raise ValueError(f'started {started}')\n"
        + hear.strip()
        + "\nraise Exception(f'started {started}')"
    )
    attack = leaks("import os, time\nos.write(ends[1], format(x, '.6f').encode())\ntime.sleep(600)")
    return Attack("tells", (cell,), attack.answer, attack.earns)


_GOT = "raise Exception('GOT ' + str(found))"
RESTARTS = {
    "after a restart, by a file": restarts(
        "open('/tmp/left', 'w').write(x)",
        f"if os.path.exists('/tmp/left'):\n    found = open('/tmp/left').read()\n    {_GOT}"),
    "after a restart, by shared memory": restarts(
        "open('/dev/shm/left', 'w').write(x)",
        f"if os.path.exists('/dev/shm/left'):\n    found = open('/dev/shm/left').read()\n    {_GOT}"),
    "after a restart, by devices' times": restarts(
        "for name, d in zip(('null', 'zero', 'full', 'random', 'urandom'), digits):\n"
        "    time.sleep(0.1 * (d % 2))\n    os.utime('/dev/' + name)",
        "found = [time.time() - os.stat('/dev/' + n).st_mtime for n in ('null', 'zero', 'full', 'random', 'urandom')]\n"
        f"if max(found) < 20: {_GOT}"),
    "after a restart, by the terminal's time": restarts(
        "os.utime('/dev/pts/ptmx')",
        "found = time.time() - os.stat('/dev/pts/ptmx').st_mtime if os.path.exists('/dev/pts/ptmx') else 99\n"
        f"if 0 < found < 20: {_GOT}"),
    "after a restart, by the numbers of pipes": restarts(  # the kernel numbers them for all processes
        "kept = [os.pipe() for _ in range(5 * digits[1])]",
        "print('count', os.fstat(os.pipe()[0]).st_ino)"),
    "after a restart, by the clock on the wall": restarts(
        "while int(time.time() * 4) % 10 != digits[1]: time.sleep(0.01)"),
}  # fmt: skip

SECRETS = {**FILES, **NETWORK, **INSIDE, **KERNEL, **FEEDBACK, **RESTARTS}
