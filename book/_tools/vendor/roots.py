"""Make all signs of a root in a font as narrow as the smallest: python roots.py FONT.

Chromium leaves room for the widest sign behind every root.
"""

import sys

from fontTools.ttLib import TTFont

font = TTFont(sys.argv[1], recalcTimestamp=False)
signs, glyphs, widths = font["MATH"].table.MathVariants, font["glyf"], font["hmtx"].metrics
root = signs.VertGlyphConstruction[signs.VertGlyphCoverage.glyphs.index("radical")]
parts = {x.VariantGlyph for x in root.MathGlyphVariantRecord}
for part in sorted(parts | {x.glyph for x in root.GlyphAssembly.PartRecords}):
    (wide, left), (narrow, _) = widths[part], widths["radical"]
    glyphs[part].coordinates.scale((narrow / wide, 1))
    glyphs[part].recalcBounds(glyphs)
    widths[part] = narrow, round(left * narrow / wide)
font.save(sys.argv[1])
