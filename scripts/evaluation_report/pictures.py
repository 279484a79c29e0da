"""The pictures, as PNG files."""

import io

import matplotlib
matplotlib.use("Agg")
import matplotlib.backends.backend_agg  # noqa: E402
import matplotlib.collections  # noqa: E402
import matplotlib.image  # noqa: E402
import matplotlib.pyplot as plt  # noqa: E402
import numpy  # noqa: E402
import PIL.Image  # noqa: E402

from . import record, solids  # noqa: E402
from .looks import COLORS, LEVEL_COLORS  # noqa: E402

ROWS = (("clearance_m", "nearest thing [mm]", 1e3, min, "#1f78b4"),
        ("visible", "least seen link [%]", 1e2, min, "#6a3d9a"),
        ("map_age_s", "map's age [s]", 1.0, max, "#b15928"))
MAP_COLORS = "viridis"
CLOSE_M = 0.3  # up, down and to both sides of what a stop is about


def of(found):
    """Yields the name of each picture, and what makes it."""
    for _number, name, _stop, scene in found.drawn_scenes():
        yield name + ".png", lambda scene=scene: draw_scene(scene)
    yield "timeline.png", lambda: draw_timeline(found)
    yield "map_from_above.png", lambda: draw_from_above(found)
    yield "map_in_3d.png", lambda: draw_map(found)
    if found.timing is not None:
        yield "latency.png", lambda: draw_latency(found)


def png(figure):
    """The same bytes in each run: no date, no version. Of few colours, so that it is small."""
    raw, small = io.BytesIO(), io.BytesIO()
    figure.savefig(raw, dpi=100, metadata={"Software": None})
    plt.close(figure)
    image = PIL.Image.open(raw).convert("RGB").quantize(160, dither=PIL.Image.NONE)
    image.save(small, "PNG", optimize=True)
    return small.getvalue()


def plain(text):
    """No formula, whatever is in it."""
    return text.replace("$", r"\$")


def shaded(triangles, color, towards):
    """A colour for each: brighter where it faces the light."""
    normals = numpy.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    lengths = numpy.linalg.norm(normals, axis=1)
    facing = numpy.abs(normals @ (towards[2] + 0.7 * towards[1])) / numpy.where(
        lengths > 0.0, lengths, 1.0) / 1.22
    rgb = numpy.array(matplotlib.colors.to_rgb(color))
    return numpy.clip(numpy.outer(0.55 + 0.5 * facing, rgb), 0.0, 1.0)


def paint(axes, layers, towards, zorder):
    """@param layers triangles [n, 3, 3] and their colour; what is nearer covers."""
    layers = [layer for layer in layers if len(layer[0])]
    if not layers:
        return
    triangles = numpy.concatenate([layer[0] for layer in layers])
    colors = numpy.concatenate([shaded(*layer, towards) for layer in layers])
    seen = triangles @ towards.T
    sides, others = seen[:, 1, :2] - seen[:, 0, :2], seen[:, 2, :2] - seen[:, 0, :2]
    facing = sides[:, 0] * others[:, 1] - sides[:, 1] * others[:, 0] > 0.0
    seen, colors = seen[facing], colors[facing]
    order = numpy.argsort(seen[:, :, 2].mean(axis=1), kind="stable")
    axes.add_collection(matplotlib.collections.PolyCollection(
        seen[order, :, :2], facecolors=colors[order], linewidths=0, zorder=zorder,
        antialiaseds=False))


def glaze(axes, layer, opacity, towards, zorder):
    """The layer as it would be painted, and all of it to be seen through alike.
    @pre the axes have their limits"""
    size = axes.get_window_extent().size / 100.0
    figure = matplotlib.figure.Figure(figsize=size, dpi=100, facecolor="none")
    canvas = matplotlib.backends.backend_agg.FigureCanvasAgg(figure)
    whole = figure.add_axes((0, 0, 1, 1), xlim=axes.get_xlim(), ylim=axes.get_ylim())
    whole.set_axis_off()
    paint(whole, [layer], towards, 1)
    canvas.draw()
    pixels = numpy.array(canvas.buffer_rgba())
    pixels[:, :, 3] = (opacity * pixels[:, :, 3]).astype(pixels.dtype)
    image = matplotlib.image.AxesImage(axes, zorder=zorder, origin="upper",
                                       extent=axes.get_xlim() + axes.get_ylim())
    image.set_data(pixels)
    axes.add_image(image)


def paint_scene(axes, scene, towards):
    """All of a stop; what it is about shows through what is before it.
    @pre the axes have their limits"""
    layers = list(scene.layers())
    paint(axes, [(triangles, COLORS[kind]) for kind, triangles, _opacity in layers
                 if kind in ("map", "held")], towards, 1)
    for kind, triangles, opacity in layers:
        if kind not in ("map", "held", "touched", "hides"):
            glaze(axes, (triangles, COLORS[kind]), opacity, towards, 2)
    paint(axes, [(triangles, COLORS[kind]) for kind, triangles, _opacity in layers
                 if kind in ("touched", "hides")], towards, 3)
    if len(scene.unseen):
        seen = scene.unseen @ towards.T
        axes.scatter(seen[:, 0], seen[:, 1], s=6, color=COLORS["unseen"], zorder=3)
    for sensor in scene.sensors:
        draw_sensor(axes, scene, sensor, towards)


def look_at(axes, middle, half):
    """All of a rectangle, without stretching it."""
    size = axes.get_window_extent().size
    half = numpy.maximum(half, half[::-1] * size / size[::-1])
    axes.set_xlim(middle[0] - half[0], middle[0] + half[0])
    axes.set_ylim(middle[1] - half[1], middle[1] + half[1])
    return half


def draw_scene(scene):
    """On the left all of it, on the right what it is about, where that is known."""
    count = 1 if scene.point is None else 2
    figure, both = plt.subplots(1, count, figsize=(11.4, 4.9), squeeze=False)
    figure.subplots_adjust(left=0.01, right=0.99, top=0.94, bottom=0.08, wspace=0.02)
    towards = solids.screen(solids.direction(*scene.view))
    low, high = scene.extent(towards)
    look_at(both[0, 0], 0.5 * (low + high), 0.5 * (high - low))
    both[0, 0].set_title(plain("all of it" if count == 2 else scene.short_text()), loc="left",
                         fontsize=10)
    if count == 2:
        close_up(both[0, 0], both[0, 1], scene, towards)
    for axes in both[0]:
        axes.set_xticks([])
        axes.set_yticks([])
        paint_scene(axes, scene, towards)
    figure.legend(handles=legend(scene), loc="lower center", ncol=8, fontsize=8, frameon=False,
                  columnspacing=1.2, handletextpad=0.4, handlelength=1.5)
    return png(figure)


def close_up(overview, axes, scene, towards):
    middle = towards[:2] @ scene.point
    close_m = min(CLOSE_M, 0.25 * (overview.get_xlim()[1] - overview.get_xlim()[0]))
    half = look_at(axes, middle, numpy.full(2, close_m))
    axes.set_title(plain(scene.short_text()), loc="left", fontsize=10, fontweight="bold")
    overview.add_patch(matplotlib.patches.Rectangle(
        middle - half, *(2.0 * half), fill=False, linewidth=1.0, zorder=6))
    axes.annotate(plain(scene.what_text()), middle, xytext=(0.98, 0.04), textcoords="axes fraction",
                  ha="right", fontsize=9, zorder=8, color="black",
                  bbox={"boxstyle": "round", "facecolor": "white", "alpha": 0.9},
                  arrowprops={"arrowstyle": "->", "color": "black", "linewidth": 1.2})


def draw_sensor(axes, scene, sensor, towards):
    place = towards[:2] @ numpy.array(sensor["position"])
    axes.plot(*place, "D", color=COLORS["sensor"], markersize=7, zorder=7, clip_on=True)
    axes.annotate(plain(sensor["name"] or "sensor"), place, xytext=(6, 6), textcoords="offset points",
                  fontsize=8, zorder=7, annotation_clip=True)
    if scene.point is not None and sensor["saw"]:
        line = numpy.array([place, towards[:2] @ scene.point])
        axes.plot(line[:, 0], line[:, 1], "--", color=COLORS["sensor"], linewidth=1.3, zorder=5)


def legend(scene):
    handles = [matplotlib.patches.Patch(color=COLORS[kind], label=text)
               for kind, text in scene.legend()]
    return handles + [matplotlib.lines.Line2D([], [], color=COLORS["sensor"], linestyle="--",
                                              marker="D", label="from where it saw it")]


def draw_timeline(found):
    reasons = [one for one in record.WORDS if any(row["reason"] == one for row in found.rows)]
    figure, axes = plt.subplots(4, 1, figsize=(11.4, 5.4 + 0.2 * len(reasons)), sharex=True,
                                gridspec_kw={"height_ratios": (1 + 0.4 * len(reasons), 2, 2, 2)})
    some = record.bounded(record.segments(found.rows))
    least = 0.002 * max([end for _begin, end, *_ in some] or [1.0])
    for level, color in LEVEL_COLORS.items():
        for begin, end, of_level, reason, _link in some:
            if of_level == level and reason in reasons:
                axes[0].barh(reasons.index(reason), max(end - begin, least), left=begin, color=color,
                             height=0.8)
    axes[0].set_yticks(range(len(reasons)))
    axes[0].set_yticklabels(reasons, fontsize=8)
    axes[0].legend(handles=[matplotlib.patches.Patch(color=color, label=level)
                            for level, color in LEVEL_COLORS.items()],
                   loc="lower right", bbox_to_anchor=(1.0, 1.0), ncol=4, fontsize=8, frameon=False)
    for axis, (column, label, scale, worst, color) in zip(axes[1:], ROWS):
        times, values = record.series(found.rows, column, worst)
        axis.plot(times, [numpy.nan if v is None else scale * v for v in values], color=color,
                  linewidth=1.2)
        axis.set_ylabel(label, fontsize=8)
        axis.set_ylim(bottom=0.0, top=105.0 if column == "visible" else None)
        axis.grid(color="0.9")
    for number, stop in enumerate(found.stops, 1):
        for axis in axes:
            axis.axvspan(stop["from_s"], stop["to_s"], color="#e4473b", alpha=0.07, linewidth=0)
        if number <= 20:
            axes[0].text(stop["from_s"], 1.02, f"stop {number}", fontsize=8,
                         transform=axes[0].get_xaxis_transform())
    axes[-1].set_xlabel("time since the recording's first message [s]")
    figure.tight_layout()
    return png(figure)


def map_boxes(found):
    """All sensors' cuboids."""
    some = [box for one in found.scenes["maps"] for box in one["cuboids"] + one["held"]]
    return numpy.array(some, dtype=float).reshape(-1, 6)


def draw_from_above(found):
    """x ahead is up, y to the left is left, as one stands behind the robot."""
    figure, axes = plt.subplots(figsize=(7.6, 6.2))
    some = map_boxes(found)
    some = some[numpy.argsort(some[:, 5], kind="stable")]
    corners = [[(-b[1], b[0]), (-b[4], b[0]), (-b[4], b[3]), (-b[1], b[3])] for b in some]
    collection = matplotlib.collections.PolyCollection(corners, cmap=MAP_COLORS, linewidths=0)
    collection.set_array(some[:, 5])
    axes.add_collection(collection)
    figure.colorbar(collection, ax=axes, label=f"height [m] above {found.scenes['fixed_frame']}")
    for shape in found.scenes.get("robot_at_the_end", []):
        triangles = solids.placed(shape)[:, :, :2]
        axes.add_collection(matplotlib.collections.PolyCollection(
            triangles[:, :, ::-1] * (-1, 1), facecolors=COLORS["robot"], linewidths=0, alpha=0.15))
    for one in found.scenes["maps"]:
        x, y, _z = one["position"]
        axes.plot(-y, x, "D", color=COLORS["sensor"])
        axes.annotate(plain(one["sensor"] or "sensor"), (-y, x), xytext=(6, 6),
                      textcoords="offset points", fontsize=8)
    draw_places(axes, found)
    x0, y0, x1, y1 = found.scenes["area"]
    axes.add_patch(matplotlib.patches.Rectangle((-y1, x0), y1 - y0, x1 - x0, fill=False,
                                                linestyle=":", color="0.4"))
    axes.set_xlim(-y1 - 0.15, -y0 + 0.15)
    axes.set_ylim(x0 - 0.45, x1 + 0.15)
    axes.set_aspect("equal")
    axes.set_xlabel("to the right (-y) [m]")
    axes.set_ylabel("ahead (x) [m]")
    figure.tight_layout()
    return png(figure)


def draw_places(axes, found):
    """Where stops came about."""
    for number, name, _stop, scene in found.drawn_scenes():
        if not name[-1].isdigit() or scene.point is None:
            continue
        x, y, _z = scene.point
        axes.plot(-y, x, "o", markersize=11, markerfacecolor="none", markeredgewidth=2,
                  color=COLORS["touched"])
        axes.annotate(f"stop {number}", (-y, x), xytext=(9, -3), textcoords="offset points",
                      fontsize=9, fontweight="bold", color=COLORS["touched"])


def draw_map(found):
    figure = plt.figure(figsize=(7.6, 6.2))
    axes = figure.add_axes((0.01, 0.01, 0.98, 0.98))
    axes.set_axis_off()
    towards = solids.screen(solids.direction(*solids.MAP_VIEW))
    some = map_boxes(found)
    robot = [solids.placed(shape) for shape in found.scenes.get("robot_at_the_end", [])]
    points = [solids.boxes(some).reshape(-1, 3)] + [body.reshape(-1, 3) for body in robot]
    seen = numpy.concatenate(points) @ towards[:2].T
    if not len(seen):
        return png(figure)
    low, high = seen.min(axis=0) - 0.05, seen.max(axis=0) + 0.05
    look_at(axes, 0.5 * (low + high), 0.5 * (high - low))
    if len(some):
        low, high = some[:, 5].min(), some[:, 5].max()
        shades = matplotlib.cm.get_cmap(MAP_COLORS)((some[:, 5] - low) / max(1e-9, high - low))
        paint(axes, [(solids.boxes(some[i:i + 1]), shade[:3]) for i, shade in enumerate(shades)],
              towards, 1)
    if robot:
        glaze(axes, (numpy.concatenate(robot), COLORS["robot"]), 0.45, towards, 2)
    for one in found.scenes["maps"]:
        axes.plot(*(towards[:2] @ numpy.array(one["position"])), "D", color=COLORS["sensor"])
    return png(figure)


def draw_latency(found):
    """How long checks took after a scan: another one in each run."""
    figure, axes = plt.subplots(figsize=(11.4, 3.2))
    scans, totals = found.timing.get("scans", {}), found.timing["time_us"]["scan_to_verdict"]
    axes.plot(scans.get("time_s", []), scans.get("scan_to_verdict_us", []), ".", markersize=3,
              color="#1f78b4")
    for key, text in (("p50", "half of them took less"), ("p99", "99 of 100 took less")):
        if totals[key] is not None:
            axes.axhline(totals[key], color="0.3", linewidth=0.8)
            axes.annotate(f"{text}: {totals[key]:.0f} us", (0.005, totals[key]), fontsize=8,
                          xycoords=("axes fraction", "data"), va="bottom")
    axes.set_ylim(bottom=0.0)
    axes.set_ylabel("scan to verdict [us]")
    axes.set_xlabel("time since the recording's first message [s]")
    figure.tight_layout()
    return png(figure)
