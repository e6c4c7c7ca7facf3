"""What the real-time functions of the daemon may reach. A new entry needs its reason."""
import dataclasses

# Arithmetic and copies of fixed size: no lock, no memory, no exception. Debian's x86-64 calls a
# library for these four operations on numbers.
ARITHMETIC = frozenset({'memcpy', 'memmove', 'memset', 'fmax', 'fmin', 'ldexp', '__popcountdi2'})


@dataclasses.dataclass(frozen=True)
class Root:
    """One function that a real-time thread runs in each period."""
    name: str         # as C++ writes it, to its parenthesis
    may_call: frozenset  # functions of other libraries
    stack_bytes: int  # at most, with all that it calls in this program
    interfaces: tuple = ()  # that it calls through, mangled
    wrappers: tuple = ()    # classes of these that call another object of the interface


# Law and Observer: all laws and estimators.
_CONTROL = ('N7flexarm3LawE', 'N7flexarm8ObserverE')

ROOTS = (
    Root('flexarm::ControlStep::Step(', ARITHMETIC, 24_000, _CONTROL),
    Root('flexarm::ControlTask::Run(', ARITHMETIC, 28_000, _CONTROL),
    # A futex is woken, never waited for: it shortens the wait of a bus thread. The lines of GPIO
    # are one ioctl each; its time is measured, and too long a call is a trip (docs/safety.md).
    Root('flexarm::SafetyTask::Run(',
         ARITHMETIC | {'syscall', 'gpiod_line_get_value_bulk', 'gpiod_line_set_value_bulk',
                       'gpiod_line_request_get_values', 'gpiod_line_request_set_values'},
         4_000, ('N7flexarm11SafetyLinesE',), ('N7flexarm10TimedLinesE',)),
)
