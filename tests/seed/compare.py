"""Checks that tiles of an archive have the bytes that a server answers with.

    compare.py ARCHIVE.mbtiles URL STYLE COUNT      COUNT random tiles, half of them with unique content"""

import random
import sqlite3
import sys
import urllib.request


def main(archive, url, style, count):
    database = sqlite3.connect(f"file:{archive}?mode=ro", uri=True)
    chance = random.Random(1)
    rare = database.execute(
        "SELECT zoom_level, tile_column, tile_row FROM map GROUP BY tile_id HAVING count(*) = 1").fetchall()
    some = database.execute("SELECT min(rowid), max(rowid) FROM map").fetchone()
    places = [chance.choice(rare) for _ in range(count // 2)] if rare else []
    while len(places) < count:
        row = chance.randint(*some)
        places += database.execute("SELECT zoom_level, tile_column, tile_row FROM map WHERE rowid = ?", (row,))
    wrong = 0
    for zoom, column, row in places:
        (data,) = database.execute(
            "SELECT tile_data FROM tiles WHERE zoom_level = ? AND tile_column = ? AND tile_row = ?",
            (zoom, column, row)).fetchone()
        target = f"{url}/{zoom}/{column}/{2 ** zoom - 1 - row}.png?{style}"
        with urllib.request.urlopen(target) as answer:
            if answer.read() != data:
                print("other bytes:", target)
                wrong += 1
    print(f"{len(places)} tiles, {len(rare)} that are alone in what they show, {wrong} differ")
    return wrong > 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2], sys.argv[3], int(sys.argv[4])))
