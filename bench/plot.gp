# Time against error, ten-bar needle linkage at 180 positions. Variables: out, data, limit.
set terminal svg size 800,560 font 'Helvetica,14' background rgb 'white'
set output out
set logscale xy
set format x '10^{%T}'
set format y '10^{%T}'
set xlabel 'ns per dyad and position'
set ylabel 'largest relative error of the output point'
set title 'Ten-bar needle linkage, 180 positions: time against error'
set xrange [0.2:20000]
set yrange [1e-35:1]
set grid lc rgb '#dddddd'
set key outside bottom center horizontal maxrows 3
set arrow 1 from real(limit), graph 0 to real(limit), graph 1 nohead dt 2 lc rgb '#888888'
set label 1 'yardstick' at real(limit)*0.9, 1e-28 rotate by 90 tc rgb '#666666' font ',11'
plot data index 0 using 2:3 with points pt 7 ps 1.4 lc rgb '#c0392b' title 'psalm (real32, real64, real128)', \
     data index 1 using 2:3 with points pt 5 ps 1.2 lc rgb '#2c3e50' title 'direct formulas of 1977', \
     data index 2 using 2:3 with points pt 9 ps 1.4 lc rgb '#2980b9' title 'Newton-Raphson', \
     data index 3 using 2:3 with linespoints pt 11 ps 1.4 lc rgb '#27ae60' title 'Adams integration'
