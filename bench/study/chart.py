"""Charts with two logarithmic axes, as SVG, written by hand; and power laws fitted to points."""
import math

# Distinct on white and for the colour-blind (Okabe & Ito, 2008), darkest first.
COLOURS = ["#000000", "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#999999"]
MARKS = ["circle", "square", "diamond", "up", "down", "circle", "square", "diamond"]
WIDTH, HEIGHT = 760, 440
LEFT, TOP, PLOT_WIDTH, PLOT_HEIGHT = 70, 44, 460, 336


def fit(points):
    """(factor, exponent) of the power law y = factor x^exponent, by least squares of logarithms."""
    logs = [(math.log(x), math.log(y)) for x, y in points if x > 0 and y > 0]
    if len(logs) < 2 or len({x for x, _ in logs}) < 2:
        return None
    mx = sum(x for x, _ in logs) / len(logs)
    my = sum(y for _, y in logs) / len(logs)
    exponent = (sum((x - mx) * (y - my) for x, y in logs) / sum((x - mx) ** 2 for x, _ in logs))
    return math.exp(my - exponent * mx), exponent


def log_log(title, x_label, y_label, series, fit_from=0):
    """SVG text. `series`: (name, [(x, y), ...]) pairs. Through the points of each with x >= fit_from
    goes a power law, its exponent in the legend; the others are joined by a thin line."""
    xs = [x for _, points in series for x, y in points if y > 0]
    ys = [y for _, points in series for _, y in points if y > 0]
    axes = Axes(limits(xs), limits(ys))
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}" '
           f'viewBox="0 0 {WIDTH} {HEIGHT}" font-family="DejaVu Sans, Verdana, sans-serif" font-size="12">',
           f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#ffffff"/>',
           f'<text x="{LEFT}" y="24" font-size="15" font-weight="bold">{escape(title)}</text>']
    out += axes.draw(x_label, y_label)
    out.append(f'<text x="{WIDTH - 14}" y="{TOP + 10}" text-anchor="end" fill="#555555">exponent</text>')
    # The legend goes from the highest line at the right end to the lowest, as the eye meets them.
    ordered = sorted(enumerate(series), key=lambda s: -max(s[1][1])[1] if s[1][1] else 0)
    for row, (i, (name, points)) in enumerate(ordered):
        colour, mark = COLOURS[i % len(COLOURS)], MARKS[i % len(MARKS)]
        points = [(x, y) for x, y in points if y > 0]
        tail = sorted(p for p in points if p[0] >= fit_from)
        head = sorted(p for p in points if p[0] < fit_from) + tail[:1]
        law = fit(tail)
        if len(head) > 1:
            out.append(axes.line(head, colour, 0.7))
        if law:
            out.append(axes.line([(x, law[0] * x ** law[1]) for x, _ in (tail[0], tail[-1])], colour, 1.5))
        out += [draw_mark(mark, axes.x(x), axes.y(y), colour) for x, y in points]
        y = TOP + 32 + 20 * row
        out.append(draw_mark(mark, LEFT + PLOT_WIDTH + 20, y - 4, colour))
        out.append(f'<text x="{LEFT + PLOT_WIDTH + 32}" y="{y}">{escape(name)}</text>')
        if law:
            out.append(f'<text x="{WIDTH - 14}" y="{y}" text-anchor="end">{law[1]:.2f}</text>')
    out.append("</svg>\n")
    return "\n".join(out)


def limits(values):
    """A range with a little air around the values, at least a factor of 3 wide."""
    low, high = min(values) / 1.25, max(values) * 1.25
    if high / low < 3:
        low, high = low / 1.5, high * 1.5
    return low, high


class Axes:
    def __init__(self, x_limits, y_limits):
        self.x_limits, self.y_limits = x_limits, y_limits

    def x(self, value):
        return LEFT + PLOT_WIDTH * share(value, self.x_limits)

    def y(self, value):
        return TOP + PLOT_HEIGHT * (1 - share(value, self.y_limits))

    def line(self, points, colour, width):
        path = " ".join(f"{self.x(x):.1f},{self.y(clip(y, self.y_limits)):.1f}" for x, y in points)
        return f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="{width}" opacity="0.8"/>'

    def draw(self, x_label, y_label):
        bottom, right = TOP + PLOT_HEIGHT, LEFT + PLOT_WIDTH
        out = []
        for value, major in ticks(self.x_limits):
            at = f"{self.x(value):.1f}"
            out.append(f'<line x1="{at}" y1="{TOP}" x2="{at}" y2="{bottom}" stroke="{grid(major)}"/>')
            if major:
                out.append(f'<text x="{at}" y="{bottom + 17}" text-anchor="middle">{number(value)}</text>')
        for value, major in ticks(self.y_limits):
            at = f"{self.y(value):.1f}"
            out.append(f'<line x1="{LEFT}" y1="{at}" x2="{right}" y2="{at}" stroke="{grid(major)}"/>')
            if major:
                out.append(f'<text x="{LEFT - 7}" y="{float(at) + 4:.1f}" text-anchor="end">{number(value)}</text>')
        out.append(f'<rect x="{LEFT}" y="{TOP}" width="{PLOT_WIDTH}" height="{PLOT_HEIGHT}" fill="none" '
                   'stroke="#444444"/>')
        out.append(f'<text x="{(LEFT + right) / 2}" y="{bottom + 40}" text-anchor="middle">{escape(x_label)}</text>')
        middle = TOP + PLOT_HEIGHT / 2
        out.append(f'<text x="20" y="{middle}" text-anchor="middle" transform="rotate(-90 20 {middle})">'
                   f'{escape(y_label)}</text>')
        return out


def share(value, limits_):
    return math.log(value / limits_[0]) / math.log(limits_[1] / limits_[0])


def clip(value, limits_):
    return min(max(value, limits_[0]), limits_[1])


def ticks(limits_):
    """(value, labelled) within the limits: powers of ten are labelled, and 2 and 5 times them where
    there are few of those; unlabelled lines at all digits."""
    low, high = limits_
    labelled = (1,) if high / low > 300 else (1, 2, 5)
    result = []
    for power in range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1):
        for digit in range(1, 10):
            value = digit * 10.0 ** power
            if low <= value <= high:
                result.append((value, digit in labelled))
    return result


def grid(major):
    return "#cfcfcf" if major else "#efefef"


def number(value):
    """1000000 as 1 M, 0.01 as it is."""
    for limit, unit in ((1e9, " G"), (1e6, " M"), (1e4, " k")):
        if value >= limit * 0.999:
            scale = 1e3 if unit == " k" else limit
            return f"{value / scale:g}{unit}"
    return f"{value:g}"


def draw_mark(kind, x, y, colour):
    if kind == "circle":
        return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.6" fill="{colour}"/>'
    shapes = {"square": [(-3.3, -3.3), (3.3, -3.3), (3.3, 3.3), (-3.3, 3.3)],
              "diamond": [(0, -4.6), (4.6, 0), (0, 4.6), (-4.6, 0)],
              "up": [(0, -4.4), (4.2, 3.4), (-4.2, 3.4)], "down": [(0, 4.4), (4.2, -3.4), (-4.2, -3.4)]}
    points = " ".join(f"{x + dx:.1f},{y + dy:.1f}" for dx, dy in shapes[kind])
    return f'<polygon points="{points}" fill="{colour}"/>'


def escape(text):
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
