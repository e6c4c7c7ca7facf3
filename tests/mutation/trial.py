"""One input: the files that it is made of, and what programs did with it."""

import os
import shlex

import judge


class Trial:
    """An input in a folder of its own. `found` lists what was wrong, with the command."""

    def __init__(self, chosen, folder, programs):
        self.chosen = chosen
        self.folder = folder
        self.programs = programs
        self.found = []
        self._kept = {}

    def write(self, name, data):
        """An input file, which no program may change."""
        file = self.folder / name
        file.write_bytes(data)
        return self.keep(file)

    def keep(self, file):
        self._kept[file] = judge.digest(file)
        return file

    def flexarm(self, *arguments, codes=(0, 1, 2), names=(), program="flexarm"):
        """Runs the program and judges it. @returns how it ended"""
        command = [self.programs.path(program), *arguments]
        ended = judge.run(command, self.folder)
        said = judge.problems(ended, codes, names)
        for file, before in self._kept.items():
            after = judge.digest(file)
            if after != before:
                said.append(f"the input {file.name} is {'gone' if after == 'gone' else 'changed'}")
                self._kept[file] = after
        self.add([program, *arguments], said, ended)
        return ended

    def add(self, command, said, ended=None):
        words = [os.fsdecode(part) for part in command]
        typed = shlex.join(words)[:300].encode(errors="backslashreplace").decode()
        for text in said:
            told = f"\n      {ended.told[:300]}" if ended is not None and ended.told else ""
            self.found.append(f"{typed}: {text}{told}")
