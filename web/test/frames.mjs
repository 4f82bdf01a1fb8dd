// What presses in tests and benches: the same numbers in each run, without Math.sin(), which browsers round differently.

/** Steps between -1 and 1 and back, once in `period` frames. */
const swing = (frame, period) => {
  const at = (frame % period) / period;
  return at < 0.5 ? 4 * at - 1 : 3 - 4 * at;
};

/** The box of a skin at rest: [lowest, highest], m. */
export function boxOf(vertices) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  vertices.forEach((x, k) => {
    low[k % 3] = Math.min(low[k % 3], x);
    high[k % 3] = Math.max(high[k % 3], x);
  });
  return [low, high];
}

/** The highest point of a skin. */
export function topOf(vertices) {
  let top = 0;
  for (let v = 0; v < vertices.length; v += 3) if (vertices[v + 2] > vertices[top + 2]) top = v;
  return Array.from(vertices.subarray(top, top + 3));
}

function finger([x, y, z], depth, radius = 0.008) {
  const tip = z + radius - depth;
  return { a: [x, y, tip], b: [x + 0.01, y, tip + 0.06], radiusA: radius, radiusB: 1.1 * radius };
}

/** Things of one frame. @param kind  'finger', 'palm', 'eight fingers' or 'all', one after the other */
export function thingsOf(kind, frame, vertices) {
  const top = topOf(vertices), depth = 0.0015 + 0.0025 * swing(frame, 60), along = 0.006 * swing(frame, 97);
  switch (kind) {
    case 'finger':
      return [{ id: 1, capsules: [finger([top[0] + along, top[1], top[2]], depth)] }];
    case 'palm': { // four parallel capsules
      const capsules = [-1.5, -0.5, 0.5, 1.5].map((k) => {
        const y = top[1] + 0.018 * k, z = top[2] + 0.012 - depth;
        return { a: [top[0] - 0.035 + along, y, z], b: [top[0] + 0.035 + along, y, z], radiusA: 0.012, radiusB: 0.012 };
      });
      return [{ id: 2, capsules }];
    }
    case 'eight fingers': { // two hands that come from both sides, at four heights
      const [low, high] = boxOf(vertices), middle = (low[1] + high[1]) / 2;
      return [0, 1].map((side) => ({
        id: 10 + side,
        capsules: [0, 1, 2, 3].map((k) => {
          const from = side ? high[0] : low[0], way = side ? 1 : -1;
          const x = from + way * (0.008 - depth), z = low[2] + (0.35 + 0.13 * k) * (high[2] - low[2]);
          return { a: [x, middle + along, z], b: [x + way * 0.06, middle + along, z], radiusA: 0.008, radiusB: 0.009 };
        }),
      }));
    }
    case 'all':
      return thingsOf(['finger', 'palm', 'eight fingers'][Math.trunc(frame / 100) % 3], frame, vertices);
    default:
      throw new Error(kind);
  }
}
