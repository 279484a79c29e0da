"""Maps of cuboids that a test makes up, and a status that goes with them."""

import math

import rospy

from tccm_monitor.msg import Cuboid, CuboidFlag, CuboidMap, Looks, MonitorStatus

STATIC, DYNAMIC = 127, 0  # as dyn
CELL, QUANTUM = 0.02, 0.001  # [m]


def empty_map(cells_x, cells_y, frame="base_link", origin=(0.0, -1.0)):
    return CuboidMap(
        header=rospy.Header(frame_id=frame, stamp=rospy.Time.now()), serial=1, origin_x=origin[0],
        origin_y=origin[1], cell_size=CELL, cells_x=cells_x, cells_y=cells_y, height_min=0.0,
        height_max=2.0, height_quantum=QUANTUM, thickness=CELL, window_scans=40, complete=True,
        window=rospy.Duration(1.5), look_period=rospy.Duration(1.5), self_share=math.nan,
        looks=Looks(resolution=math.radians(1.0)))


def cuboid(cell, bottom, top, **fields):
    return Cuboid(cell=cell, top=top, depth=top - bottom, points=9, **fields)


def fill(message, x_range, y_range, bottom, top, **fields):
    """Adds a block of cells, given by their numbers along x and y."""
    message.cuboids += [cuboid(y * message.cells_x + x, bottom, top, **fields)
                        for y in range(*y_range) for x in range(*x_range)]
    message.cuboids.sort(key=lambda one: (one.cell, one.top))
    return message


def waves(count, phase, layers=1):
    """A map of so many cuboids that moves with the phase [rad]. No two have the same heights."""
    side = math.ceil(math.sqrt(count / layers))
    message = empty_map(side, side, origin=(-0.2, -side * CELL / 2.0))
    for cell in range(side * side):
        x, y = cell % side, cell // side
        height = 0.6 + 0.25 * math.sin(0.11 * x + phase) * math.cos(0.09 * y + phase)
        for layer in range(layers):
            top = height + 0.3 * layer
            message.cuboids.append(cuboid(cell, top - 0.04, top, held=layer == 1 and cell % 9 == 0,
                                          dyn=STATIC if (x // 8 + y // 8) % 4 else DYNAMIC))
    del message.cuboids[count:]
    return message


def status(level, reason, detail, flagged=(), **fields):
    message = MonitorStatus(level=level, reason=reason, reasons=[reason], detail=detail, **fields)
    message.flagged = [CuboidFlag(cell=one.cell, bottom=one.top - one.depth, top=one.top,
                                  col=Cuboid.COLLISION) for one in flagged]
    return message
