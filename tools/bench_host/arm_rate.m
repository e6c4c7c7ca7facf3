% Right-hand side of the plant for GNU Octave: y' = f(y), y = [q; q'], as PlantRate of plant_rate.h.
% Written apart from it: the mass matrix is formed (model/arm/arm_model.cpp) and the system solved.
% Symbols: model/symbols.md. arm: constants and torques, as bench-host writes them.
function y_dot = arm_rate (arm, y)
  n = 4 + arm.m1 + arm.m2;
  i1 = 5:4+arm.m1;
  i2 = 5+arm.m1:n;
  q = y(1:n);
  v = y(n+1:2*n);
  f1 = q(i1);  f1_dot = v(i1);
  f2 = q(i2);  f2_dot = v(i2);
  N1f1 = arm.N1 * f1;
  N2f2 = arm.N2 * f2;

  % Tip of link 1, and the direction of link 2.
  w = arm.psi1' * f1;  w_dot = arm.psi1' * f1_dot;  s = arm.slope1' * f1;
  e = 1 / (1 + s^2);
  alpha_dot = e * (arm.slope1' * f1_dot);
  kappa = -2 * s * alpha_dot^2;
  sb = sqrt (e) * (sin (q(2)) + s * cos (q(2)));
  cb = sqrt (e) * (cos (q(2)) - s * sin (q(2)));
  s2 = arm.slope2' * f2;
  e2 = 1 / (1 + s2^2);
  kappa2 = -2 * s2 * (e2 * (arm.slope2' * f2_dot))^2;
  Sy = arm.k2' * f2;
  I2 = arm.I2 + f2' * N2f2;

  % Velocities per rate: the elbow along and across link 2, and the bodies that turn.
  along = zeros (n, 1);
  across = along;
  turn = along;
  along(1) = -cb * w + sb * arm.L1;  along(i1) = sb * arm.psi1;
  across(1) = sb * w + cb * arm.L1;  across(i1) = cb * arm.psi1;
  turn(1) = 1;  turn(i1) = e * arm.slope1;
  gamma = turn;  gamma(2) = 1;
  rotor2 = turn;  rotor2(4) = 1;
  payload = gamma;  payload(i2) = e2 * arm.slope2;

  M = zeros (n, n);
  M(1,1) = arm.I1 + f1' * N1f1;
  M(3,3) = arm.J1;
  M(i1,1) = arm.a1;  M(1,i1) = arm.a1';
  M(i1,i1) = arm.N1;
  M(i2,i2) = arm.N2;
  coupling = arm.k2 * across(1:i2(1)-1)' + arm.a2 * gamma(1:i2(1)-1)';
  M(i2,1:i2(1)-1) = coupling;  M(1:i2(1)-1,i2) = coupling';
  with_gamma = (arm.Sx * across - Sy * along) * gamma';
  M += arm.m * (along * along' + across * across') + with_gamma + with_gamma' ...
       + I2 * (gamma * gamma') + arm.Ir2 * (turn * turn') + arm.J2 * (rotor2 * rotor2') ...
       + arm.Ip * (payload * payload');

  % Forces that are quadratic in the rates.
  w1 = v(1);
  x1 = -2 * w1 * w_dot - w1^2 * arm.L1;
  y1 = -w1^2 * w;
  X = cb * x1 + sb * y1;
  Y = -sb * x1 + cb * y1;
  g = w1 + v(2) + alpha_dot;
  P = arm.Ip * (kappa + kappa2);
  F_x = arm.m * X - Sy * kappa - g^2 * arm.Sx - 2 * g * (arm.k2' * f2_dot);
  F_y = arm.m * Y + arm.Sx * kappa - g^2 * Sy;
  T = -Sy * X + arm.Sx * Y + I2 * kappa + 2 * g * (N2f2' * f2_dot) + P;
  motor = T + (arm.Ir2 + arm.J2) * kappa;
  f_x1 = cb * F_x - sb * F_y;
  f_y1 = sb * F_x + cb * F_y;
  bias = zeros (n, 1);
  bias(1) = 2 * w1 * (N1f1' * f1_dot) - w * f_x1 + arm.L1 * f_y1 + motor;
  bias(2) = T;
  bias(4) = arm.J2 * kappa;
  bias(i1) = -w1^2 * N1f1 + f_y1 * arm.psi1 + (e * motor) * arm.slope1;
  bias(i2) = Y * arm.k2 + kappa * arm.a2 - g^2 * N2f2 + (e2 * P) * arm.slope2;

  spring1 = arm.K1 * (q(3) - q(1));
  spring2 = arm.K2 * (q(4) - q(2));
  force = zeros (n, 1);
  force(1) = spring1 - arm.b1 * v(1);
  force(2) = spring2 - arm.b2 * v(2);
  force(3) = arm.torque(1) - spring1;
  force(4) = arm.torque(2) - spring2;
  force(i1) = -arm.G1 * f1 - arm.D1 * f1_dot;
  force(i2) = -arm.G2 * f2 - arm.D2 * f2_dot;
  y_dot = [v; M \ (force - bias)];
end
