// Numbers of axes, whatever page they are on: how they are written, round ones, ends of a range.
'use strict';

globalThis.scales = (() => {
  const FLAT = 1e-8;        // a curve that varies by less than this part of the scale is constant: nine digits are sent
  const AROUND = 0.01;      // part of the scale that is shown on either side of a constant

  /** A number with at most seven digits, a dash if it is not known. */
  const short = (v) => !isFinite(v) ? '\u2013' : Number(v.toPrecision(7)).toString();

  /** Round numbers from a to b, about `count`, at least two; with `angles` steps that divide a turn. */
  function ticks(a, b, count, angles = false) {
    const low = Math.min(a, b), high = Math.max(a, b), rough = (high - low) / count || 1;
    const power = 10 ** Math.floor(Math.log10(rough));
    const turns = [15, 30, 45, 90, 180, 360].find((s) => s >= rough * 0.999);
    const step = angles && rough > 10 && turns ? turns : power * [1, 2, 5, 10].find((s) => s * power >= rough * 0.999);
    const list = [];
    for (let v = Math.ceil(low / step - 1e-9) * step; v <= high + 1e-9 * step; v += step)
      list.push(Math.abs(v) < 1e-9 * step ? 0 : v);
    // one number gives no scale
    return list.length < 2 && high > low ? ticks(a, b, 2 * count, angles) : list;
  }

  /** Powers of ten between two, given by their logarithms, with 2 and 5 times them where there are few. */
  function decades(low, high) {
    const list = [];
    for (let k = Math.floor(low); k <= high; k++) for (const m of high - low > 3 ? [1] : [1, 2, 5]) {
      const v = m * 10 ** k;
      if (Math.log10(v) >= low - 1e-9 && Math.log10(v) <= high + 1e-9) list.push(v);
    }
    // within a part of a decade round numbers are as good, and there are more
    return list.length < 2 ? ticks(10 ** low, 10 ** high, 4) : list;
  }

  /** Ends of an axis for values from low to high on a linkage of the given size; rounding is not magnified. */
  function range(low, high, size) {
    if (!(high >= low)) return [0, 1];
    if (high - low >= FLAT * size) return [low, high];
    const middle = Math.abs(low) < FLAT * size ? 0 : (low + high) / 2;
    if (!(size > 0)) return [low - 1, high + 1];
    return [middle - AROUND * size, middle + AROUND * size];
  }

  return { short, ticks, decades, range };
})();
