"""How far it is: a bar on a terminal, lines elsewhere."""

import shutil
import sys
import threading

BAR = 30


class Progress:
    """On standard error."""

    def __init__(self, count, program):
        self.count, self.program, self.done, self.running = count, program, 0, []
        self.is_terminal = sys.stderr.isatty()
        self.lock = threading.Lock()

    def begins(self, name):
        with self.lock:
            again = name in self.running
            if not again:
                self.running.append(name)
            if again:
                self.line(f"again    {name}: the worker that had it is gone")
            elif not self.is_terminal:
                self.line(f"running  {name}")
            self.draw()

    def ends(self, name, text):
        with self.lock:
            self.done += 1
            if name in self.running:
                self.running.remove(name)
            self.line(f"done     {name}: {text} ({self.done} of {self.count})")
            self.draw()

    def note(self, text):
        with self.lock:
            self.line(f"{self.program}: {text}")
            self.draw()

    def line(self, text):
        print(("\r\x1b[K" if self.is_terminal else "") + text, file=sys.stderr, flush=True)

    def draw(self):
        if not self.is_terminal:
            return
        filled = BAR * self.done // max(1, self.count)
        text = f"[{'#' * filled:{BAR}}] {self.done} of {self.count}"
        if self.running and self.done < self.count:
            text += ": " + ", ".join(self.running)
        width = shutil.get_terminal_size().columns - 1
        text = text if len(text) <= width else text[:width - 3] + "..."
        print("\r\x1b[K" + text, end="" if self.done < self.count else "\n", file=sys.stderr, flush=True)
