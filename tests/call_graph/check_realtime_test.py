#!/usr/bin/env python3
"""The check finds every kind of fault in a program made for it, and none in the daemon."""
import os
import pathlib
import unittest

import check_realtime
import realtime_rules

PROGRAMS = pathlib.Path(os.environ['FLEXARM_BIN'])
UNFIT = os.environ['FLEXARM_UNFIT_PROGRAM']


def problems(function, may_call=(), interfaces=()):
    """Of a function of the unfit program that may take 1 kB of stack: far more than a leaf needs."""
    root = realtime_rules.Root(f'unfit::{function}(', frozenset(may_call), 1_000, interfaces)
    return check_realtime.check(UNFIT, [root])


class Unfit(unittest.TestCase):
    def assert_one(self, found, *texts):
        for text in texts:
            self.assertTrue(any(text in problem for problem in found), f'{text}: {found}')

    def test_what_only_adds_passes(self):
        self.assertEqual(problems('Adds'), [])

    def test_an_exception(self):
        self.assert_one(problems('Throws'), '__cxa_throw: is not among')

    def test_the_heap(self):
        self.assert_one(problems('Allocates'), 'operator new: is not among')

    def test_the_mathematical_library_unless_it_is_listed(self):
        self.assert_one(problems('CallsMathLibrary'), 'pow: is not among')
        self.assertEqual(problems('CallsMathLibrary', ['pow']), [])

    def test_stack_of_unknown_size(self):
        self.assert_one(problems('TakesAnyStack'), 'stack that only the run decides')

    def test_much_stack(self):
        self.assert_one(problems('TakesMuchStack'), 'bytes of stack, at most 1000')

    def test_recursion(self):
        self.assert_one(problems('Recurses'), 'unfit::Recurses: recursion')

    def test_a_pointer(self):
        self.assert_one(problems('CallsPointer'), 'unfit::CallsPointer: calls through a pointer')

    def test_a_class_behind_an_interface(self):
        self.assert_one(problems('CallsInterface'), 'calls through a pointer')
        self.assert_one(problems('CallsInterface', interfaces=('N5unfit5ShapeE',)),
                        'unfit::CallsInterface -> unfit::Polygon::Area -> operator new')

    def test_the_chain_of_calls_is_named(self):
        self.assert_one(problems('CallsOneThatThrows'), 'unfit::CallsOneThatThrows -> unfit::Throws')

    def test_a_function_that_is_not_there(self):
        self.assert_one(problems('Vanished'), '0 functions of this name')


class Daemon(unittest.TestCase):
    def test_its_realtime_functions_obey_the_rules(self):
        self.assertEqual(check_realtime.check(PROGRAMS / 'flexarmd', realtime_rules.ROOTS), [])


if __name__ == '__main__':
    unittest.main(verbosity=2)
