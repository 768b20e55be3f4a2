!> Coefficients of the explicit Runge-Kutta method of order 8 with errors of orders 5 and 3 by Dormand and Prince.
!>
!> Source: Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, second edition, II.5 and II.10 (DOP853). The
!> conditions of all 200 trees up to order 8, and those of both errors, are in `test_ode`.
module psalm_dormand_prince
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: stages, nodes, weights, stage_weights, error_fifth, error_third

   integer, parameter :: stages = 12
   real(wp), parameter :: nodes(stages) = [ & !! parts of a step at which the stages are
      0.0_wp, 0.526001519587677318785587544488e-01_wp, 0.789002279381515978178381316732e-01_wp, &
      0.118350341907227396726757197510_wp, 0.281649658092772603273242802490_wp, 1.0_wp/3.0_wp, &
      0.25_wp, 4.0_wp/13.0_wp, 0.651282051282051282051282051282_wp, &
      0.6_wp, 6.0_wp/7.0_wp, 1.0_wp]
   real(wp), parameter :: weights(stages) = [ & !! of the stages in a step
      5.42937341165687622380535766363e-2_wp, 0.0_wp, 0.0_wp, &
      0.0_wp, 0.0_wp, 4.45031289275240888144113950566_wp, &
      1.89151789931450038304281599044_wp, -5.8012039600105847814672114227_wp, 3.1116436695781989440891606237e-1_wp, &
      -1.52160949662516078556178806805e-1_wp, 2.01365400804030348374776537501e-1_wp, 4.47106157277725905176885569043e-2_wp]
   real(wp), parameter :: error_fifth(stages) = [ & !! weights less those of a method of order 5
      0.1312004499419488073250102996e-1_wp, 0.0_wp, 0.0_wp, &
      0.0_wp, 0.0_wp, -0.1225156446376204440720569753e+1_wp, &
      -0.4957589496572501915214079952_wp, 0.1664377182454986536961530415e+1_wp, -0.3503288487499736816886487290_wp, &
      0.3341791187130174790297318841_wp, 0.8192320648511571246570742613e-1_wp, -0.2235530786388629525884427845e-1_wp]
   real(wp), parameter :: third(stages) = [ & !! weights of a method of order 3
      31.0_wp/127.0_wp, 0.0_wp, 0.0_wp, &
      0.0_wp, 0.0_wp, 0.0_wp, &
      0.0_wp, 0.0_wp, 0.733846688281611857341361741547_wp, &
      0.0_wp, 0.0_wp, 3.0_wp/136.0_wp]
   real(wp), parameter :: error_third(stages) = weights - third
   real(wp), parameter :: row_2(stages) = [ &
      5.26001519587677318785587544488e-2_wp, &
      spread(0.0_wp, 1, 11)]
   real(wp), parameter :: row_3(stages) = [ &
      1.97250569845378994544595329183e-2_wp, 5.91751709536136983633785987549e-2_wp, &
      spread(0.0_wp, 1, 10)]
   real(wp), parameter :: row_4(stages) = [ &
      2.95875854768068491816892993775e-2_wp, 0.0_wp, 8.87627564304205475450678981324e-2_wp, &
      spread(0.0_wp, 1, 9)]
   real(wp), parameter :: row_5(stages) = [ &
      2.41365134159266685502369798665e-1_wp, 0.0_wp, -8.84549479328286085344864962717e-1_wp, &
      9.24834003261792003115737966543e-1_wp, &
      spread(0.0_wp, 1, 8)]
   real(wp), parameter :: row_6(stages) = [ &
      3.7037037037037037037037037037e-2_wp, 0.0_wp, 0.0_wp, &
      1.70828608729473871279604482173e-1_wp, 1.25467687566822425016691814123e-1_wp, &
      spread(0.0_wp, 1, 7)]
   real(wp), parameter :: row_7(stages) = [ &
      3.7109375e-2_wp, 0.0_wp, 0.0_wp, &
      1.70252211019544039314978060272e-1_wp, 6.02165389804559606850219397283e-2_wp, -1.7578125e-2_wp, &
      spread(0.0_wp, 1, 6)]
   real(wp), parameter :: row_8(stages) = [ &
      3.70920001185047927108779319836e-2_wp, 0.0_wp, 0.0_wp, &
      1.70383925712239993810214054705e-1_wp, 1.07262030446373284651809199168e-1_wp, -1.53194377486244017527936158236e-2_wp, &
      8.27378916381402288758473766002e-3_wp, &
      spread(0.0_wp, 1, 5)]
   real(wp), parameter :: row_9(stages) = [ &
      6.24110958716075717114429577812e-1_wp, 0.0_wp, 0.0_wp, &
      -3.36089262944694129406857109825_wp, -8.68219346841726006818189891453e-1_wp, 2.75920996994467083049415600797e1_wp, &
      2.01540675504778934086186788979e1_wp, -4.34898841810699588477366255144e1_wp, &
      spread(0.0_wp, 1, 4)]
   real(wp), parameter :: row_10(stages) = [ &
      4.77662536438264365890433908527e-1_wp, 0.0_wp, 0.0_wp, &
      -2.48811461997166764192642586468_wp, -5.90290826836842996371446475743e-1_wp, 2.12300514481811942347288949897e1_wp, &
      1.52792336328824235832596922938e1_wp, -3.32882109689848629194453265587e1_wp, -2.03312017085086261358222928593e-2_wp, &
      spread(0.0_wp, 1, 3)]
   real(wp), parameter :: row_11(stages) = [ &
      -9.3714243008598732571704021658e-1_wp, 0.0_wp, 0.0_wp, &
      5.18637242884406370830023853209_wp, 1.09143734899672957818500254654_wp, -8.14978701074692612513997267357_wp, &
      -1.85200656599969598641566180701e1_wp, 2.27394870993505042818970056734e1_wp, 2.49360555267965238987089396762_wp, &
      -3.0467644718982195003823669022_wp, &
      spread(0.0_wp, 1, 2)]
   real(wp), parameter :: row_12(stages) = [ &
      2.27331014751653820792359768449_wp, 0.0_wp, 0.0_wp, &
      -1.05344954667372501984066689879e1_wp, -2.00087205822486249909675718444_wp, -1.79589318631187989172765950534e1_wp, &
      2.79488845294199600508499808837e1_wp, -2.85899827713502369474065508674_wp, -8.87285693353062954433549289258_wp, &
      1.23605671757943030647266201528e1_wp, 6.43392746015763530355970484046e-1_wp, &
      spread(0.0_wp, 1, 1)]
   !> Shape (stages, stages): weights of the stages before one, in its column.
   real(wp), parameter :: stage_weights(stages, stages) = reshape([spread(0.0_wp, 1, stages), row_2, row_3, row_4, row_5, row_6, &
                                                                  row_7, row_8, row_9, row_10, row_11, row_12], [stages, stages])
end module psalm_dormand_prince
