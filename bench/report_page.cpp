// The style and the script of the page. Chart.js is there when the script runs.
#include "report_html.h"

namespace limn::bench {

const char* const kPageStyle = R"css(
body { font: 14px/1.45 system-ui, sans-serif; color: #1d2429; max-width: 1180px; margin: 2em auto; padding: 0 1.5em; }
h1 { font-size: 1.7em; margin-bottom: .4em; }
h2 { font-size: 1.2em; margin-top: 2em; border-bottom: 1px solid #ccd3d8; padding-bottom: .2em; }
table { border-collapse: collapse; font-size: 12.5px; font-variant-numeric: tabular-nums; }
th, td { text-align: left; padding: .2em .9em .2em 0; border-bottom: 1px solid #e8ecef; vertical-align: top; }
th { font-weight: 600; color: #47545d; }
#charts { display: grid; grid-template-columns: 1fr 1fr; gap: 1.6em; }
#charts figure { margin: 0; position: relative; height: 360px; min-width: 0; }
#charts figure.wide { grid-column: 1 / -1; height: 420px; }
.small { font-size: 12px; color: #5b6871; }
@media (max-width: 800px) { #charts { grid-template-columns: 1fr; } }
)css";

const char* const kPageScript = R"js(
(function () {
  'use strict';
  const report = JSON.parse(document.getElementById('data').textContent);
  const rows = report.rows.filter(row => row.median_ms > 0);
  const peers = ['#c2410c', '#b45309', '#7c2d92', '#15803d', '#be185d', '#57534e', '#0f766e', '#a16207'];
  const ours = ['#1d4ed8', '#0891b2', '#4f46e5', '#0369a1'];
  Chart.defaults.animation = false;
  Chart.defaults.font.family = 'system-ui, sans-serif';
  Chart.defaults.maintainAspectRatio = false;

  function draw(title, wide, config) {
    const figure = document.createElement('figure'), canvas = document.createElement('canvas');
    if (wide) figure.className = 'wide';
    figure.append(canvas);
    document.getElementById('charts').append(figure);
    config.options.plugins = Object.assign({
      title: { display: true, text: title, align: 'start', font: { size: 14 } },
      legend: { position: 'bottom', labels: { boxWidth: 12, boxHeight: 3 } }
    }, config.options.plugins);
    new Chart(canvas, config);
  }
  const plain = value => value >= 1e6 ? value / 1e6 + 'M' : value >= 1e3 ? value / 1e3 + 'k' : String(+value.toPrecision(3));
  const logarithmic = title => ({
    type: 'logarithmic', title: { display: true, text: title },
    ticks: { callback: value => [1, 2, 5].includes(+String(value.toExponential()).split('e')[0]) ? plain(value) : '' }
  });
  const linear = (title, values) => ({
    type: 'linear', title: { display: true, text: title }, afterBuildTicks: axis => {
      axis.ticks = [...new Set(values)].sort((a, b) => a - b).map(value => ({ value }));
    }
  });
  const unique = values => [...new Set(values)];

  // The fastest row of each key at each x.
  function best(list, key, x) {
    const found = new Map();
    for (const row of list) {
      const at = key(row) + ' ' + x(row);
      if (!found.has(at) || row.median_ms < found.get(at).median_ms) found.set(at, row);
    }
    return [...found.values()];
  }
  // Lines of points, one for each key; limn in blue and thick.
  function series(list, key, x, y) {
    let our = 0, their = 0;
    return unique(list.map(key)).map(name => {
      const part = list.filter(row => key(row) === name), limn = part[0].side === 'limn';
      const color = limn ? ours[our++ % ours.length] : peers[their++ % peers.length];
      return {
        label: name, data: part.map(row => ({ x: x(row), y: y(row) })), borderColor: color, backgroundColor: color,
        borderWidth: limn ? 2.5 : 1.2, borderDash: limn ? [] : [5, 3], pointRadius: limn ? 3.5 : 2.5
      };
    });
  }
  function lines(title, list, key, x, y, xAxis, yTitle) {
    if (unique(list.map(x)).length < 2) return;
    draw(title, false, { type: 'line', data: { datasets: series(list, key, x, y) },
                         options: { scales: { x: xAxis, y: logarithmic(yTitle) } } });
  }

  // Geometric means of how many times faster limn's best is.
  function ratios() {
    const groups = new Map();
    for (const row of rows) {
      const group = row.name.slice(0, row.name.lastIndexOf('/'));
      if (!groups.has(group)) groups.set(group, { scenario: row.scenario });
      const side = row.side === 'limn' ? 'limn' : row.evaluator.startsWith('loop') ? 'loop' : 'osd';
      const best = groups.get(group);
      best[side] = Math.min(best[side] ?? Infinity, row.median_ms);
    }
    const names = unique(rows.map(row => row.scenario));
    const mean = (scenario, side) => {
      const logs = [...groups.values()].filter(g => g.scenario === scenario && g.limn && g[side])
                                       .map(g => Math.log(g[side] / g.limn));
      return logs.length ? Math.exp(logs.reduce((a, b) => a + b, 0) / logs.length) : null;
    };
    const bars = (label, values, color) => ({ label, data: values, backgroundColor: color, base: 1, maxBarThickness: 22 });
    const all = scenario => {
      const logs = [...groups.values()].filter(g => g.scenario === scenario && g.limn && (g.osd || g.loop))
                                       .map(g => Math.log(Math.min(g.osd ?? Infinity, g.loop ?? Infinity) / g.limn));
      return logs.length ? Math.exp(logs.reduce((a, b) => a + b, 0) / logs.length) : null;
    };
    draw('How many times faster limn is: geometric means of all tasks (left of 1: slower)', true, {
      type: 'bar',
      data: { labels: names, datasets: [bars('than the best of all peers', names.map(all), '#1d4ed8'),
                                        bars('than the best of OpenSubdiv', names.map(n => mean(n, 'osd')), '#c2410c'),
                                        bars('than the best plain loop', names.map(n => mean(n, 'loop')), '#15803d')] },
      options: { indexAxis: 'y', scales: { x: logarithmic('times faster') } }
    });
  }

  function roofline() {
    const list = rows.filter(row => row.bytes > 0 && row.flops > 0);
    if (!list.length) return;
    const x = row => row.flops / row.bytes, y = row => row.flops / row.median_ms / 1e6;
    const key = row => row.scenario + ', ' + (row.side === 'limn' ? 'limn' : row.evaluator.startsWith('loop') ? 'loop' : 'OpenSubdiv');
    const shapes = { limn: 'circle', loop: 'rect', OpenSubdiv: 'triangle' };
    const sets = series(list, key, x, y);
    for (const set of sets) {
      set.showLine = false;
      set.pointStyle = shapes[set.label.split(', ')[1]];
      for (const [i, row] of list.filter(row => key(row) === set.label).entries()) set.data[i].name = row.name;
    }
    const least = Math.min(...list.map(x)) / 1.5, most = Math.max(...list.map(x)) * 1.5, rate = report.device_copy_bytes_per_second / 1e9;
    sets.push({ label: 'copy bandwidth of the device, ' + rate.toFixed(1) + ' GB/s', showLine: true, pointRadius: 0,
                borderColor: '#1d2429', backgroundColor: '#1d2429', borderWidth: 1.5,
                data: [{ x: least, y: least * rate }, { x: most, y: most * rate }] });
    draw('Roofline: above the line only what stays in the cache gets', true, {
      type: 'scatter', data: { datasets: sets },
      options: { scales: { x: logarithmic('flops per byte that must move'), y: logarithmic('Gflop/s') },
                 plugins: { legend: { position: 'bottom', labels: { usePointStyle: true, boxWidth: 8, boxHeight: 8 } },
                            tooltip: { callbacks: { label: item => item.raw.name || item.dataset.label } } } }
    });
  }

  ratios();
  // One line for each machine, whatever its tables and paddings.
  const evaluator = row => row.evaluator.replace(/_(chain|composed|xyzw|separate)/g, ''), ms = row => row.median_ms;
  lines('Time per face over mesh size', rows.filter(row => row.scenario === 'scaling'),
        row => row.task + ', ' + row.evaluator, row => row.parameters.faces,
        row => row.median_ms * 1e6 / row.parameters.faces, logarithmic('faces'), 'ns per face');
  const over = (scenario, task, parameter, title) => {
    const list = rows.filter(row => row.scenario === scenario && row.parameters[parameter] > 0 && (!task || row.task === task));
    for (const model of unique(list.map(row => row.model))) {
      const part = best(list.filter(row => row.model === model), evaluator, row => row.parameters[parameter]);
      lines(title + ': ' + model, part, evaluator, row => row.parameters[parameter], ms,
            linear(parameter, part.map(row => row.parameters[parameter])), 'ms');
    }
  };
  over('stencil_eval', '', 'level', 'Uniform refinement, time over level');
  over('grid_eval', 'normals', 'rate', 'Limit grids, time over rate');
  over('tessellate', '', 'rate', 'Tessellation, time over rate');
  roofline();
})();
)js";

}  // namespace limn::bench
