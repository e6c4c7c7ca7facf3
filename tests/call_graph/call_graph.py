"""The functions that a linked program can call from a root: read from its machine code (objdump),
symbols and relocations (nm, readelf), so inlined and outlined code count as they run.

A virtual call goes to that slot of every class that derives from one of the given interfaces; where
the slot is not seen, to any slot of these but destructors. What cannot be resolved is a finding.
x86-64, position-independent programs of GCC or Clang.
"""
import collections
import dataclasses
import functools
import re
import subprocess

WORD = 8
RETURN_ADDRESS = 8  # bytes that a call pushes

_FUNCTION = re.compile(r'^[0-9a-f]+ <(.+)>:$')
_DIRECT = re.compile(r'\b(call|j[a-z]+)\s+[0-9a-f]+ <([^>+]+)(?:\+0x[0-9a-f]+)?>')
_INDIRECT = re.compile(r'\b(call|jmp)\s+\*(.+)$')
_SLOT = re.compile(r'^(0x[0-9a-f]+)?\(%r\w+\)')
_RESERVE = re.compile(r'\bsub\s+\$0x([0-9a-f]+),%rsp')
_RESERVE_ANY = re.compile(r'\bsub\s+%r\w+,%rsp')
_PROBED = re.compile(r'\blea\s+-0x([0-9a-f]+)\(%rsp\),%r11')  # of a frame that is touched page by page


@dataclasses.dataclass
class Function:
    """One symbol of the code: what it calls, and the bytes of stack it takes itself."""
    direct: set = dataclasses.field(default_factory=set)
    slots: set = dataclasses.field(default_factory=set)  # offsets in a table; None: not seen
    frame: int = 0
    takes_any_stack: bool = False


def _output(*command, text=None):
    return subprocess.run(command, input=text, capture_output=True, text=True, check=True).stdout


def demangled(names):
    """By name, as C++ writes it."""
    names = list(names)
    return dict(zip(names, _output('c++filt', text='\n'.join(names)).splitlines()))


def external_name(symbol):
    """Of a function of another library: without the mark of the linker and the version."""
    return symbol.split('@')[0]


@functools.cache
def functions(program):
    """By symbol; a part that the compiler has moved away (`.cold`, `.part`) is one too. Functions of
    other libraries have no code here."""
    found = collections.defaultdict(Function)
    name, before = None, ''
    for line in _output('objdump', '-d', '--no-show-raw-insn', program).splitlines():
        if line.startswith('0'):
            match = _FUNCTION.match(line)
            name = match[1] if match else None
            before = ''
        elif name is not None and '@plt' not in name and '\t' in line:
            _add(found[name], name, line.split('\t', 1)[1], before)
            before = line
    return found


def _add(function, name, instruction, before):
    direct = _DIRECT.search(instruction)
    if direct:
        if direct[2] != name or direct[1] == 'call':
            function.direct.add(direct[2])
        return
    indirect = _INDIRECT.search(instruction)
    if indirect:
        # A switch: the sum of a table's address and entry.
        if indirect[1] == 'jmp' and re.search(r'\badd\b', before):
            return
        slot = _SLOT.match(indirect[2])
        function.slots.add(int(slot[1] or '0', 16) if slot else None)
    elif re.search(r'\bpush\b', instruction):
        function.frame += WORD
    elif _RESERVE_ANY.search(instruction):
        function.takes_any_stack = True
    else:
        reserved = _RESERVE.search(instruction)
        if reserved:
            function.frame += int(reserved[1], 16)


class VirtualTables:
    """The tables of virtual functions of a program, with the classes they belong to."""

    def __init__(self, program):
        self._at = {}  # symbol of an address
        sizes = {}
        for line in _output('nm', '-S', program).splitlines():
            parts = line.split()
            if len(parts) == 4:
                self._at.setdefault(int(parts[0], 16), parts[3])
                sizes[parts[3]] = (int(parts[0], 16), int(parts[1], 16))
        self._word = {}  # by place in the program: the address that is stored there
        for line in _output('readelf', '-rW', program).splitlines():
            parts = line.split()
            if len(parts) == 4 and parts[2] == 'R_X86_64_RELATIVE':
                self._word[int(parts[0], 16)] = int(parts[3], 16)
        self._place = {name: place for name, place in sizes.items() if name.startswith('_ZT')}

    def _words(self, symbol):
        start, size = self._place[symbol]
        return [self._at.get(self._word.get(address))
                for address in range(start, start + size, WORD)]

    def classes_of(self, interface):
        """Mangled names (as after _ZTI) of the class and of all that derive from it."""
        bases = {symbol[4:]: {word[4:] for word in self._words(symbol) if word and word[:4] == '_ZTI'}
                 for symbol in self._place if symbol.startswith('_ZTI')}
        classes = {interface}
        while True:
            more = {name for name, of in bases.items() if of & classes} - classes
            if not more:
                return classes
            classes |= more

    def slots_of(self, mangled_class):
        """(offset in the table, symbol) of each virtual function of the class."""
        table = '_ZTV' + mangled_class
        if table not in self._place:
            return
        offset = None
        for word in self._words(table):
            if word == '_ZTI' + mangled_class:
                offset = 0
            elif offset is not None:
                if word and not word.startswith('_ZT'):
                    yield offset, word
                offset += WORD


_DESTRUCTOR = re.compile(r'D[0125]Ev$')


class CallGraph:
    """Of a program, with the interfaces (mangled names, `N7flexarm3LawE`) that it calls through.

    A wrapper implements an interface by calling another object of it, never another wrapper.
    """

    def __init__(self, program, interfaces, wrappers=()):
        self._wrappers = ['_Z' + name[:-1] for name in wrappers]
        self.functions = functions(program)
        called = set().union(*(function.direct for function in self.functions.values()))
        self._names = demangled({*self.functions, *map(external_name, called)})
        tables = VirtualTables(program)
        self._slots = collections.defaultdict(set)
        self.found_classes = set()
        for interface in interfaces:
            for name in tables.classes_of(interface):
                for offset, symbol in tables.slots_of(name):
                    self.found_classes.add(name)
                    self._slots[offset].add(symbol)
        self._any_slot = {symbol for symbols in self._slots.values() for symbol in symbols
                          if not _DESTRUCTOR.search(symbol)}

    def roots(self, prefix):
        """Symbols whose name in C++ begins with it, without what was moved out of them."""
        return [symbol for symbol in self.functions
                if self._names[symbol].startswith(prefix) and '.' not in symbol]

    def name(self, symbol):
        """As C++ writes it, without its parameters."""
        return self._names.get(external_name(symbol), symbol).split('(')[0]

    def calls(self, symbol):
        """What it calls, virtual calls resolved."""
        function = self.functions.get(symbol, Function())
        called = set(function.direct)
        by_table = set()
        for slot in function.slots:
            by_table |= self._any_slot if slot is None else self._slots.get(slot, set())
        for wrapper in self._wrappers:
            if symbol.startswith(wrapper):
                by_table = {other for other in by_table if not other.startswith(wrapper)}
        return called | by_table

    def unresolved(self, symbol):
        """Whether it calls through a table or pointer of which nothing is known."""
        return any(not (self._any_slot if slot is None else self._slots.get(slot))
                   for slot in self.functions.get(symbol, Function()).slots)

    def reached(self, roots):
        """By symbol reached: the symbol that calls it, None for a root."""
        caller = {root: None for root in roots}
        waiting = list(roots)
        while waiting:
            symbol = waiting.pop()
            for called in self.calls(symbol):
                if called not in caller:
                    caller[called] = symbol
                    waiting.append(called)
        return caller

    def deepest(self, root):
        """(bytes of stack, chain of symbols) of the deepest chain of calls; the second is a cycle,
        and the first None, if there is recursion."""
        known, path = {}, []

        def depth(symbol):
            if symbol in path:
                raise RecursionError(path[path.index(symbol):] + [symbol])
            if symbol not in known:
                path.append(symbol)
                below = max((depth(called) for called in self.calls(symbol)), default=(0, []))
                path.pop()
                own = self.functions.get(symbol, Function()).frame + RETURN_ADDRESS
                known[symbol] = (own + below[0], [symbol] + below[1])
            return known[symbol]

        try:
            return depth(root)
        except RecursionError as cycle:
            return None, cycle.args[0]
