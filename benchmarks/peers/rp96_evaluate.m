% [eta_b, g] of a design of the reference problem RP-96, typed from docs/rp96.md for GNU Octave.
% z = (zS, zP1, zR1, zP2, zR2), v = (xS, xP1, xR1, xP2, xR2, m2, d); every g >= 0 where its
% constraint holds.  Lengths in modules of stage 1.
function [eta_b, g] = rp96_evaluate (z, v)
  alpha = pi / 9;
  ca = cos (alpha);
  ta = tan (alpha);
  inv_a = ta - alpha;
  % Columns: the meshes S-P1, P1-R1, P2-R2; sign +1 external, -1 internal.
  sign = [1; -1; -1];
  m = [1; 1; v(6)];
  z1 = [z(1); z(2); z(4)];
  z2 = [z(2); z(3); z(5)];
  x1 = [v(1); v(2); v(4)];
  x2 = [v(2); v(3); v(5)];
  d = v(7);
  rb1 = m .* z1 * ca / 2;
  rb2 = m .* z2 * ca / 2;
  cos_w = (rb2 + sign .* rb1) / d;
  aw = acos (min (cos_w, 1 - 1e-12));  % undefined beyond: 1 - cos_w is a constraint
  tan_w = tan (aw);
  line = d * sqrt (max (1 - cos_w .^ 2, 0));
  ra1 = m .* (z1 / 2 + 1 + x1);
  ra2 = m .* (z2 / 2 + sign + x2);
  t1 = sqrt (ra1 .^ 2 - rb1 .^ 2);
  t2 = sqrt (max (ra2 .^ 2 - rb2 .^ 2, 0));
  pb = pi * m * ca;
  e1 = (t1 - rb1 .* tan_w) ./ pb;
  e2 = sign .* (t2 - rb2 .* tan_w) ./ pb;
  e = e1 + e2;
  eta = 1 - 0.1 * pi * (1 ./ z1 + sign ./ z2) .* (1 - e + e1 .^ 2 + e2 .^ 2);
  j = sign .* m * ca .* ((z2 + sign .* z1) .* (tan_w - aw - inv_a) - 2 * ta * (x2 + sign .* x1));

  G1 = z(3) / z(1);
  G2 = z(4) * z(3) / (z(2) * z(5));
  ratio = (1 + G1) / (1 - G2);
  phi = j / ca ./ [ratio * z(1) / 2; z(3) / 2; v(6) * z(5) / 2];
  limit = pi / 180 * 8 / 60;

  zt = [z(1); z(2); z(4)];
  xt = [v(1); v(2); v(4)];
  tip = zt + 2 + 2 * xt;
  at = acos (zt * ca ./ tip);
  thickness = tip .* ((pi / 2 + 2 * xt * ta) ./ zt + inv_a - tan (at) + at);

  gap = 2 * d * sin (pi / 3) - [1; v(6)] .* ([z(2); z(4)] + 2 + 2 * [v(2); v(4)]);
  g = [j; e - 1.2; 2 - e; 1 - cos_w;
       1 - (phi(1) + phi(2)) / limit; 1 - (phi(1) + phi(3)) / limit;
       thickness - 0.25; xt - 1 + zt * sin(alpha)^2 / 2; gap - 0.5;
       t2(2:3) - line(2:3); ra2(2:3) - rb2(2:3); line(1) - t1(1); line(1) - t2(1)];
  eta_b = eta(1) * (1 + G1) * (eta(2) * eta(3) - G2) ...
          / (eta(3) * (G1 + eta(1) * eta(2)) * (1 - G2));
end
