# Bands of the output, divided by the tolerance of the lengths. Variables: out, small, large, open.
set terminal svg size 900,460 font 'Helvetica,13' background rgb 'white'
set output out
set multiplot layout 1,2
set xlabel 'crank angle, degrees'
set xrange [0:360]
set xtics 90
set yrange [-8:8]
set grid lc rgb '#dddddd'
set key bottom center font ',11'
set ylabel 'deviation of the output / tolerance, degrees per mm'
set title 'tolerance 0.02 mm, 0.008 degrees'
s = 0.02
plot small using 1:(-$4/s):($4/s) with filledcurves fs solid 0.15 lc rgb '#2980b9' title 'linear, worst case', \
     small using 1:(-$5/sqrt(3)/s):($5/sqrt(3)/s) with filledcurves fs solid 0.35 lc rgb '#2980b9' title 'linear, one standard deviation', \
     small using 1:($6/s) with lines lw 2 lc rgb '#c0392b' title 'sample: lowest, highest', \
     small using 1:($7/s) with lines lw 2 lc rgb '#c0392b' notitle, \
     small using 1:(($8 - $9)/s) with lines lw 2 dt 2 lc rgb '#2c3e50' title 'sample: mean +- standard deviation', \
     small using 1:(($8 + $9)/s) with lines lw 2 dt 2 lc rgb '#2c3e50' notitle
set title 'tolerance 3 mm, 1.2 degrees ('.open.' of 100000 do not close)'
s = 3.0
unset ylabel
plot large using 1:(-$4/s):($4/s) with filledcurves fs solid 0.15 lc rgb '#2980b9' notitle, \
     large using 1:(-$5/sqrt(3)/s):($5/sqrt(3)/s) with filledcurves fs solid 0.35 lc rgb '#2980b9' notitle, \
     large using 1:($6/s) with lines lw 2 lc rgb '#c0392b' notitle, \
     large using 1:($7/s) with lines lw 2 lc rgb '#c0392b' notitle, \
     large using 1:(($8 - $9)/s) with lines lw 2 dt 2 lc rgb '#2c3e50' notitle, \
     large using 1:(($8 + $9)/s) with lines lw 2 dt 2 lc rgb '#2c3e50' notitle
unset multiplot
