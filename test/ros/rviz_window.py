"""rviz in a virtual display: its picture, and a mouse for it."""

import os
import shutil
import signal
import subprocess
import time

import numpy

from waiting import wait_for

PATIENCE = 60.0  # [s]: software GL, on a machine that may be busy
# Of the panel, as monitor_panel.cpp has them.
OK, STOP, SILENT, AWAITS_RESET = (46, 160, 67), (215, 40, 40), (128, 128, 128), (255, 140, 0)
BACKGROUND = (38, 40, 46)  # of the scene, as tccm_monitor.rviz has it

SIZE = (1280, 960)
NEEDED = ("rviz", "Xvfb", "import", "xdotool")


def missing():
    """@return which programs are not installed."""
    return [program for program in NEEDED if not shutil.which(program)]


class Window:
    def __init__(self, config, *arguments, log=None):
        """@param config file of rviz. @param log file for what it says; None: where we say it."""
        end, start = os.pipe()
        self.display = subprocess.Popen(
            ["Xvfb", "-displayfd", str(start), "-screen", "0", f"{SIZE[0]}x{SIZE[1]}x24",
             "-nolisten", "tcp"], pass_fds=[start], stderr=subprocess.DEVNULL)
        os.close(start)
        with os.fdopen(end) as pipe:
            number = pipe.readline().strip()
        # Edges without smoothing are exact, and software GL takes a third of the time.
        self.environment = dict(os.environ, DISPLAY=f":{number}", LIBGL_ALWAYS_SOFTWARE="1")
        self.rviz = subprocess.Popen(["rviz", "--disable-anti-aliasing", "-d", config, *arguments],
                                     env=self.environment, stdout=log, stderr=log)

    def runs(self):
        return self.rviz.poll() is None

    def close(self):
        for process, number in ((self.rviz, signal.SIGINT), (self.display, signal.SIGTERM)):
            process.send_signal(number)
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

    def picture(self):
        """@return height x width x 3 bytes: red, green and blue."""
        run = subprocess.run(["import", "-window", "root", "-depth", "8", "rgb:-"],
                             env=self.environment, check=True, capture_output=True)
        return numpy.frombuffer(run.stdout, numpy.uint8).reshape(SIZE[1], SIZE[0], 3)

    def pixels(self, color):
        """@return how many are of it."""
        return int(where(self.picture(), color).sum())

    def wait_for_color(self, color, least):
        def shown():
            """A color comes up."""
            assert self.runs(), "rviz has ended"
            return self.pixels(color) >= least
        wait_for(shown, PATIENCE)

    def wait_without(self, color):
        def gone():
            """A color goes away."""
            return self.pixels(color) == 0
        wait_for(gone, PATIENCE)

    def click_reset(self):
        self.click_button(0, 0)

    def click_button(self, column, row):
        """Of the panel's, Reset being the first, and orange."""
        x, y, width, height = box_of(where(self.picture(), AWAITS_RESET))
        # Beside the word in the middle; buttons have some pixels between them.
        self.click(x + width // 2 + column * (width + 6), y + height // 4 + row * (height + 6))

    def press_return(self, title, is_done):
        """In a window of that title, until that is done: one that has just come takes no focus."""
        def done():
            """Return is taken."""
            subprocess.run(["xdotool", "search", "--onlyvisible", "--name", title,
                            "windowfocus", "key", "--window", "%1", "Return"],
                           env=self.environment, check=False, timeout=PATIENCE, capture_output=True)
            time.sleep(0.3)
            return is_done()
        wait_for(done, PATIENCE)

    def view(self):
        """@return where the scene is in the picture."""
        return box_of(where(self.picture(), BACKGROUND))

    def panel(self):
        """@return where it is in the picture, while the level is STOP."""
        x, y, width, _ = box_of(where(self.picture(), STOP))
        return x - 10, y - 30, width + 20, 640

    def save(self, path, box):
        """@param box x, y, width and height."""
        subprocess.run(["import", "-window", "root", "-crop", "{2}x{3}+{0}+{1}".format(*box),
                        "+repage", "-strip", "+dither", "-colors", "128", "-define",
                        "png:compression-level=9", path], env=self.environment, check=True)

    def click(self, x, y):
        subprocess.run(["xdotool", "mousemove", str(x), str(y), "click", "1"],
                       env=self.environment, check=True)


def where(picture, color, tolerance=0):
    """@return a map of the pixels of that colour."""
    apart = numpy.abs(picture.astype(int) - numpy.array(color))
    return (apart <= tolerance).all(axis=2)


def box_of(mask):
    """@return x, y, width and height of what is set; None where nothing is."""
    rows, columns = numpy.flatnonzero(mask.any(axis=1)), numpy.flatnonzero(mask.any(axis=0))
    if not rows.size:
        return None
    return (int(columns[0]), int(rows[0]), int(columns[-1] - columns[0] + 1),
            int(rows[-1] - rows[0] + 1))


def coarse(path):
    """@return a picture's colours, each the mean of a square of 8 x 8 pixels; none of letters and
    edges."""
    size = subprocess.run(["identify", "-format", "%w %h", path], check=True, capture_output=True)
    width, height = (max(1, int(pixels) // 8) for pixels in size.stdout.split())
    run = subprocess.run(["convert", path, "-alpha", "off", "-scale", f"{width}x{height}!",
                          "-depth", "8", "rgb:-"], check=True, capture_output=True)
    return numpy.frombuffer(run.stdout, numpy.uint8).reshape(height, width, 3).astype(int)


def share_apart(path, other, tolerance=40):
    """@return the share of two pictures in which their colours are apart."""
    one, two = coarse(path), coarse(other)
    if one.shape != two.shape:
        return 1.0
    return float((numpy.abs(one - two).max(axis=2) > tolerance).mean())
