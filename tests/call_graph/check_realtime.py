#!/usr/bin/env python3
"""Checks what the real-time functions of a program can reach, in its machine code.

Nothing that they reach throws, uses the heap, waits, or calls a function of another library that
realtime_rules.py does not list; there is no recursion, no frame of unknown size, no call that
cannot be resolved; and the deepest chain of calls fits the stated stack. Exit code 1 if not.

usage: check_realtime.py PROGRAM
"""
import sys

import call_graph
import realtime_rules


def chain_text(graph, reached, symbol):
    """From the root to the symbol."""
    chain = [symbol]
    while reached[chain[-1]] is not None:
        chain.append(reached[chain[-1]])
    return ' -> '.join(graph.name(symbol) for symbol in reversed(chain))


def problems_of(graph, root):
    """A line for each rule that is broken."""
    symbols = graph.roots(root.name)
    if len(symbols) != 1:
        return [f'{root.name}: {len(symbols)} functions of this name: one is expected']
    reached = graph.reached(symbols)
    problems = []
    for symbol in reached:
        function = graph.functions.get(symbol)
        what = None
        if function is None:
            if call_graph.external_name(symbol) not in root.may_call:
                what = 'is not among the functions that it may call'
        elif graph.unresolved(symbol):
            what = 'calls through a pointer of which nothing is known'
        elif function.takes_any_stack:
            what = 'takes an amount of stack that only the run decides'
        if what:
            problems.append(f'{chain_text(graph, reached, symbol)}: {what}')
    depth, chain = graph.deepest(symbols[0])
    text = ' -> '.join(graph.name(symbol) for symbol in chain)
    if depth is None:
        problems.append(f'{text}: recursion')
    else:
        print(f'{root.name[:-1]}: {len(reached)} functions, {depth} of {root.stack_bytes} bytes of '
              f'stack')
        if depth > root.stack_bytes:
            problems.append(f'{text}: {depth} bytes of stack, at most {root.stack_bytes}')
    return problems


def check(program, roots):
    """The problems of all roots."""
    problems = []
    for root in roots:
        problems += problems_of(call_graph.CallGraph(program, root.interfaces, root.wrappers), root)
    return problems


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    problems = check(sys.argv[1], realtime_rules.ROOTS)
    for problem in problems:
        print(f'error: {problem}')
    sys.exit(1 if problems else 0)


if __name__ == '__main__':
    main()
