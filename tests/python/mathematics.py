"""Prints values of SQLite's mathematical functions over a grid in the form of tests/data/mathematics.csv: expression, type, value."""
import csv, sqlite3, sys
ROUND = ["ceil", "ceiling", "floor", "trunc"]
ONE = ROUND + ["acos","acosh","asin","asinh","atan","atanh","cos","cosh","degrees","exp","ln","log","log10","log2","radians","sin","sinh","sqrt","tan","tanh"]
TWO = ["atan2","log","mod","pow","power"]
X = ["-3","-1.0","-0.75","0","0.0","1e-9","0.3","1","1.0","1.5","2","7.9","10","1000","-2.5","710.5","1e308","9007199254740993","'2'","'1.5'","' 3 '","'x'","'2x'","NULL","x'32'"]
Y = ["-2","-0.5","0","0.25","1","2","3.7","10","'4'","'y'","NULL"]
db = sqlite3.connect(":memory:")
rows = [f"{f}({x})" for f in ONE for x in X] + [f"{f}({x}, {y})" for f in TWO for x in Y for y in Y] + ["pi()"]
out = csv.writer(sys.stdout, lineterminator="\n")
out.writerow(["expression", "type", "value"])
for e in rows:
    (v,) = db.execute(f"SELECT {e}").fetchone()
    t = {type(None): "null", int: "integer", float: "real"}[type(v)]
    out.writerow([e, t, "" if v is None else repr(v)])
