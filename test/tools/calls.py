"""How often a program calls procedures of its own: counted by breakpoints, as a debugger does, in the program as it is installed.

Needs Linux on x86-64 that lets a process trace its child.
"""
import ctypes
import os
import platform
import shutil
import signal
import struct
import subprocess

TRACEME, PEEKTEXT, POKETEXT, CONT, SINGLESTEP, GETREGS, SETREGS, SETOPTIONS = 0, 1, 4, 7, 9, 12, 13, 0x4200
EXIT_WITH_PARENT = 0x100000     # PTRACE_O_EXITKILL
REGISTERS, RIP = 27, 16         # of struct user_regs_struct: words, and which one tells where the program is
BREAKPOINT = 0xCC
LIBC = ctypes.CDLL(None, use_errno=True)
LIBC.ptrace.restype = ctypes.c_long
LIBC.ptrace.argtypes = [ctypes.c_long, ctypes.c_long, ctypes.c_void_p, ctypes.c_void_p]


def why_not():
    """Why calls cannot be counted on this machine; empty: they can."""
    if platform.system() != "Linux" or platform.machine() != "x86_64":
        return "calls are counted on Linux for x86-64 only"
    if shutil.which("nm") is None:
        return "there is no nm, which lists the symbols of a program"
    try:
        count_calls(["/bin/true"], {})
    except OSError as error:
        return "no process may trace its child here (%s)" % error
    return ""


def ptrace(request, pid, address=0, data=0):
    ctypes.set_errno(0)
    result = LIBC.ptrace(request, pid, address, data)
    if ctypes.get_errno():
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
    return result


def symbols_of(program):
    """Name -> address of what the program defines."""
    listed = subprocess.run(["nm", "--defined-only", program], capture_output=True, text=True, check=True).stdout
    return {line.split()[2]: int(line.split()[0], 16) for line in listed.splitlines() if len(line.split()) == 3}


def base_of(pid, program):
    """Where a program that may stand anywhere was put."""
    with open(program, "rb") as file:
        if struct.unpack("<H", file.read(18)[16:])[0] == 2:     # ET_EXEC: it stands where it was linked
            return 0
    with open("/proc/%d/maps" % pid, encoding="utf-8") as maps:
        return min(int(line.split("-")[0], 16) for line in maps if line.rstrip().endswith(os.path.realpath(program)))


def count_calls(command, addresses):
    """Run a command to its end; addresses: name -> address in the program. Returns name -> calls, and the exit status."""
    pid = os.fork()
    if pid == 0:
        try:
            nothing = os.open(os.devnull, os.O_RDWR)
            for stream in range(3):
                os.dup2(nothing, stream)
            os.environ["OMP_NUM_THREADS"] = "1"      # breakpoints are those of the first thread
            ptrace(TRACEME, 0)
            os.execv(command[0], command)
        finally:
            os._exit(127)
    _, status = os.waitpid(pid, 0)
    if not os.WIFSTOPPED(status):
        raise OSError("the program did not stop where it began")
    ptrace(SETOPTIONS, pid, 0, EXIT_WITH_PARENT)
    base = base_of(pid, command[0]) if addresses else 0
    places = {base + address: name for name, address in addresses.items()}
    calls = dict.fromkeys(addresses, 0)
    original = {place: ptrace(PEEKTEXT, pid, place) for place in places}

    def put(place, stopping):
        word = original[place]
        ptrace(POKETEXT, pid, place, ((word & ~0xFF) | BREAKPOINT if stopping else word) & (2**64 - 1))

    for place in places:
        put(place, True)
    registers = (ctypes.c_ulonglong*REGISTERS)()
    passed_on = 0
    while True:
        ptrace(CONT, pid, 0, passed_on)
        _, status = os.waitpid(pid, 0)
        if not os.WIFSTOPPED(status):
            return calls, os.waitstatus_to_exitcode(status)
        passed_on = os.WSTOPSIG(status)
        if passed_on != signal.SIGTRAP:
            continue
        passed_on = 0
        ptrace(GETREGS, pid, 0, ctypes.addressof(registers))
        place = registers[RIP] - 1
        if place not in places:
            continue
        calls[places[place]] += 1
        registers[RIP] = place
        ptrace(SETREGS, pid, 0, ctypes.addressof(registers))
        put(place, False)
        ptrace(SINGLESTEP, pid)
        os.waitpid(pid, 0)
        put(place, True)
