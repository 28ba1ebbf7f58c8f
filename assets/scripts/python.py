"""Runs one script of a player. The program starts this process, answers its requests, and waits for its end.

Standard input is a socket to the program with one JSON object per line. The first line has the code and the limits; then
each request of this process gets one response. The script has access only to the functions below.
"""
import json
import linecache
import os
import sys
import traceback
import types

#: Maximum size of a request, bytes.
MOST_REQUEST = 1 << 20

#: Paths that landlock allows to read: libraries that a script may import, and files that the C library needs.
SYSTEM = (
    "/lib", "/lib64", "/usr/lib", "/usr/lib64", "/usr/local/lib", "/usr/local/lib64", "/nix/store",
    "/usr/share/zoneinfo", "/etc/localtime", "/etc/ld.so.cache", "/dev/null", "/dev/zero", "/dev/urandom",
)

#: Blocked system calls by machine: new processes and programs, sockets and messages, signals to other processes, access to their
#: memory, limits and scheduling, memory and queues that outlive the script, keys, and permissions, times and attributes of files.
#: They follow the audit architecture of the machine and its number of prctl.
REFUSED = {
    "x86_64": (0xC000003E, 157, (
        29, 30, 31, 41, 44, 46, 53, 56, 57, 58, 59, 62, 64, 68, 90, 91, 92, 93, 94, 101, 129, 132, 141, 142, 144, 188, 189, 190,
        197, 198, 199, 200, 203, 234, 235, 240, 248, 249, 250, 251, 260, 261, 268, 280, 297, 298, 302, 307, 310, 311, 314, 321, 322, 323,
        424, 425, 434, 435, 438, 452, 463, 466,
    )),
    "aarch64": (0xC00000B7, 167, (
        5, 6, 7, 14, 15, 16, 30, 52, 53, 54, 55, 88, 117, 118, 119, 122, 129, 130, 131, 138, 140, 180, 186, 190, 194, 195, 196,
        198, 199, 206, 211, 217, 218, 219, 220, 221, 240, 241, 261, 269, 270, 271, 274, 280, 281, 282, 424, 425, 434, 435, 438, 452, 463, 466,
    )),
}


class NovamindError(Exception):
    """A rejection. The text describes the problem; ``code`` is for programs."""

    def __init__(self, code, message):
        super().__init__(code + ": " + message)
        self.code = code


class Channel:
    """The channel for requests to the program."""

    def __init__(self):
        self.up = os.dup(0)
        self.down = os.fdopen(os.dup(0), "rb")
        # A script that reads standard input gets end of file.
        nothing = os.open(os.devnull, os.O_RDONLY)
        os.dup2(nothing, 0)
        os.close(nothing)

    def receive(self):
        line = self.down.readline()
        if not line.endswith(b"\n"):
            raise EOFError
        return json.loads(line)

    def ask(self, request):
        text = json.dumps(request).encode() + b"\n"
        if len(text) > MOST_REQUEST:
            raise NovamindError("sql_error", "a statement of a script may have 1 MiB")
        try:
            while text:
                text = text[os.write(self.up, text):]
            answer = self.receive()
        except (EOFError, OSError, ValueError):
            raise NovamindError("script_failed", "the run does not answer any more") from None
        if "error" in answer:
            raise NovamindError(answer["error"]["code"], answer["error"]["message"])
        return answer


def functions(channel):
    """Returns the module ``novamind_script``."""
    module = types.ModuleType("novamind_script", "Functions for scripts to query the run.")

    def query(sql):
        """Returns the rows of one read-only SQL statement over the visible tables as a list of dicts.

        The rules and limits are those of the tool query: at most 5,000 rows; warnings and hints go to standard error.
        """
        if not isinstance(sql, str):
            raise TypeError("query takes one SQL statement as a text")
        answer = channel.ask({"ask": "query", "sql": sql})
        for remark in ("warning", "hint"):
            if remark in answer:
                print(answer[remark], file=sys.stderr)
        return answer["rows"]

    def get_vars():
        """Returns the state of the run: current_day, the last simulated day."""
        return channel.ask({"ask": "vars"})

    for own in (query, get_vars, NovamindError):
        own.__module__ = module.__name__
        setattr(module, own.__name__, own)
    return module


def limit(seconds, memory):
    """Limits the resources of the process. Skips limits that the system does not support."""
    try:
        import resource
    except ImportError:
        return
    wanted = {
        "RLIMIT_AS": memory, "RLIMIT_CPU": int(seconds) + 2, "RLIMIT_FSIZE": 0, "RLIMIT_CORE": 0, "RLIMIT_NPROC": 0,
        "RLIMIT_NOFILE": 64,
    }
    for name, most in wanted.items():
        try:
            which = getattr(resource, name)
            hard = resource.getrlimit(which)[1]
            most = most if hard == resource.RLIM_INFINITY else min(most, hard)
            resource.setrlimit(which, (most, most))
        except (AttributeError, OSError, ValueError):
            pass


def enclose():
    """Isolates the process on Linux, with each mechanism that the kernel supports."""
    if not sys.platform.startswith("linux"):
        return
    try:
        import ctypes
        libc = ctypes.CDLL(None, use_errno=True)
    except (ImportError, OSError):
        return

    def call(function, *values):
        return function(*(each if each is None or isinstance(each, ctypes._Pointer) else ctypes.c_long(each) for each in values))

    # The process ends with the program and gains no privileges; the steps below require the latter.
    call(libc.prctl, 1, 9, 0, 0, 0)
    call(libc.prctl, 38, 1, 0, 0, 0)
    # Separate namespaces for users, network and shared memory.
    if hasattr(libc, "unshare"):
        call(libc.unshare, 0x10000000 | 0x40000000)
        call(libc.unshare, 0x08000000)
    for part in (fence_files, refuse_calls):
        try:
            part(ctypes, libc, call)
        except (AttributeError, OSError, ValueError):
            pass


def fence_files(ctypes, libc, call):
    """Restricts files with landlock: libraries and the empty working folder can be read; nothing can be written or executed."""

    class Ruleset(ctypes.Structure):
        _fields_ = [("files", ctypes.c_uint64), ("network", ctypes.c_uint64), ("scope", ctypes.c_uint64)]

    class Beneath(ctypes.Structure):
        _pack_ = 1
        _fields_ = [("rights", ctypes.c_uint64), ("place", ctypes.c_int32)]

    version = call(libc.syscall, 444, None, 0, 1)
    if version < 1:
        return
    files = (1 << 13) - 1
    for since, right in ((2, 13), (3, 14), (5, 15)):
        if version >= since:
            files |= 1 << right
    rules = Ruleset(files, 3 if version >= 4 else 0, 3 if version >= 6 else 0)
    size = 24 if version >= 6 else 16 if version >= 4 else 8
    fence = call(libc.syscall, 444, ctypes.pointer(rules), size, 0)
    if fence < 0:
        return
    own = [os.path.join(prefix, name) for prefix in (sys.prefix, sys.base_prefix, sys.exec_prefix) for name in ("lib", "lib64")]
    for path in dict.fromkeys([*SYSTEM, *own, *sys.path, os.getcwd()]):
        try:
            place = os.open(path or ".", os.O_PATH | os.O_CLOEXEC)
        except OSError:
            continue
        rights = (1 << 2 | 1 << 3) if os.path.isdir(path or ".") else 1 << 2
        call(libc.syscall, 445, fence, 1, ctypes.pointer(Beneath(rights, place)), 0)
        os.close(place)
    call(libc.syscall, 446, fence, 0)
    os.close(fence)


def refuse_calls(ctypes, libc, call):
    """Blocks system calls with seccomp: they return an error."""

    class Step(ctypes.Structure):
        _fields_ = [("code", ctypes.c_uint16), ("yes", ctypes.c_uint8), ("no", ctypes.c_uint8), ("value", ctypes.c_uint32)]

    class Filter(ctypes.Structure):
        _fields_ = [("length", ctypes.c_uint16), ("steps", ctypes.POINTER(Step))]

    machine = os.uname().machine
    if machine not in REFUSED or sys.maxsize < 1 << 32:
        return
    architecture, prctl, numbers = REFUSED[machine]
    load, equal, at_least, answer = 0x20, 0x15, 0x35, 0x06
    steps = [(load, 0, 0, 4), (equal, 1, 0, architecture), (answer, 0, 0, 0x80000000), (load, 0, 0, 0)]
    # Calls of the x32 ABI, which have other numbers.
    steps.append((at_least, len(numbers) + 4, 0, 0x40000000))
    steps.extend((equal, len(numbers) - at + 3, 0, number) for at, number in enumerate(numbers))
    # Only option 1 of prctl (the signal at the death of the parent) is blocked.
    steps.extend([(equal, 0, 2, prctl), (load, 0, 0, 16), (equal, 1, 0, 1)])
    steps.extend([(answer, 0, 0, 0x7FFF0000), (answer, 0, 0, 0x00050001)])
    program = (Step * len(steps))(*(Step(*step) for step in steps))
    call(libc.prctl, 22, 2, ctypes.pointer(Filter(len(steps), ctypes.cast(program, ctypes.POINTER(Step)))), 0, 0)


def run(code, module):
    """Runs the code and returns its exit code. Prints a traceback without the frames of this file to standard error."""
    lines = code.splitlines(keepends=True)
    linecache.cache["<script>"] = (len(code), None, lines, "<script>")
    script = types.ModuleType("__main__")
    for name in ("query", "get_vars", "NovamindError"):
        setattr(script, name, getattr(module, name))
    sys.modules.update({"__main__": script, module.__name__: module})
    sys.argv = ["<script>"]
    # Memory for printing the traceback after a MemoryError.
    reserve = [bytearray(16 << 20)]
    try:
        exec(compile(code, "<script>", "exec", dont_inherit=True), script.__dict__)
        sys.stdout.flush()
    except SystemExit as leaving:
        if leaving.code is None or isinstance(leaving.code, int):
            return leaving.code or 0
        print(leaving.code, file=sys.stderr)
        return 1
    except BaseException as error:
        reserve.clear()
        frames = error.__traceback__ and error.__traceback__.tb_next
        traceback.print_exception(type(error), error, frames)
        return 1
    return 0


def main():
    channel = Channel()
    given = channel.receive()
    for stream in (sys.stdout, sys.stderr):
        stream.reconfigure(errors="backslashreplace", line_buffering=True)
    limit(given["seconds"], given["memory"])
    enclose()
    sys.exit(run(given["code"], functions(channel)) & 0xFF)


main()
