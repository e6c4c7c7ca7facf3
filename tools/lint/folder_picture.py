"""Draws the folders of the source tree and their includes, as SVG text: one row a level."""

WIDTH, HEIGHT, GAP_X, GAP_Y, MARGIN = 168, 26, 14, 44, 16
COLOURS = {"model": "#dcebf7", "hal": "#f9e3d0", "estimator": "#e3f1dc", "controller": "#efe3f5",
           "config": "#f6f0cf", "tools": "#e8e8e8"}


def levels_of(uses):
    """The longest way down from each folder: it includes lower levels only.
    @throws ValueError naming a cycle"""
    levels, on_the_way = {}, []

    def level(folder):
        if folder in on_the_way:
            raise ValueError("cycle: " + " -> ".join([*on_the_way, folder]))
        if folder not in levels:
            on_the_way.append(folder)
            levels[folder] = 1 + max((level(other) for other in uses.get(folder, ())), default=-1)
            on_the_way.pop()
        return levels[folder]

    for folder in sorted(set(uses) | {other for others in uses.values() for other in others}):
        level(folder)
    return levels


def reduced(uses):
    """The same without arrows that a longer way says as well."""
    below = {}

    def all_below(folder):
        if folder not in below:
            below[folder] = set(uses.get(folder, ()))
            for other in uses.get(folder, ()):
                below[folder] |= all_below(other)
        return below[folder]

    return {folder: {other for other in others
                     if not any(other in all_below(between) for between in others)}
            for folder, others in uses.items()}


def draw(uses):
    levels = levels_of(uses)
    rows = [sorted(f for f in levels if levels[f] == n)
            for n in range(max(levels.values(), default=-1) + 1)]
    rows.reverse()  # the programs on top
    wide = MARGIN * 2 + max((len(row) for row in rows), default=0) * (WIDTH + GAP_X)
    high = MARGIN * 2 + len(rows) * (HEIGHT + GAP_Y)
    place = {}
    for number, row in enumerate(rows):
        left = (wide - len(row) * (WIDTH + GAP_X) + GAP_X) / 2
        for column, folder in enumerate(row):
            place[folder] = (left + column * (WIDTH + GAP_X), MARGIN + number * (HEIGHT + GAP_Y))
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {wide:g} {high:g}" '
           'font-family="sans-serif" font-size="12">',
           '<style>line{stroke:#888;stroke-width:.8;marker-end:url(#a)}rect{stroke:#666}</style>',
           '<marker id="a" markerWidth="6" markerHeight="6" refX="6" refY="3" orient="auto">'
           '<path d="M0 0L6 3L0 6z" fill="#888"/></marker>',
           f'<rect width="{wide:g}" height="{high:g}" fill="white" style="stroke:none"/>']
    for folder, others in sorted(reduced(uses).items()):
        for other in sorted(others):
            (x1, y1), (x2, y2) = place[folder], place[other]
            out.append(f'<line x1="{x1 + WIDTH / 2:g}" y1="{y1 + HEIGHT:g}" '
                       f'x2="{x2 + WIDTH / 2:g}" y2="{y2:g}"/>')
    for folder, (x, y) in sorted(place.items()):
        colour = COLOURS.get(folder.split("/")[0], "white")
        out.append(f'<rect x="{x:g}" y="{y:g}" width="{WIDTH}" height="{HEIGHT}" rx="4" '
                   f'fill="{colour}"/><text x="{x + WIDTH / 2:g}" y="{y + 17:g}" '
                   f'text-anchor="middle">{folder}</text>')
    return "\n".join([*out, "</svg>"]) + "\n"
