% ode45 on the motion of solver_problem.h, for `flexarm bench-host`. Prints lines of numbers:
%   rate Y'           of each given state, for a comparison with the C++
%   race TOLERANCE SECONDS CALLS  then 20 lines `y` with the states at the instants
% Needs arm_rate.m and arm_data.m, which bench-host writes beside it.
1;
function y_dot = counted_rate (arm, y)
  global calls;
  calls += 1;
  y_dot = arm_rate (arm, y);
end

global calls;
arm_data;
for i = 1:columns (states)
  arm.torque = pushes(:,1);
  printf ("rate"); printf (" %.17g", arm_rate (arm, states(:,i))); printf ("\n");
end
fflush (stdout);
for tolerance = tolerances
  options = odeset ("RelTol", tolerance, "AbsTol", 0.1 * tolerance);
  calls = 0;
  y = zeros (rows (states), 1);
  motion = [];
  begin_s = cputime ();
  for half = 1:2
    arm.torque = pushes(:,half);
    instants = 0.5 * (half - 1) + interval * (0:10);
    [t, solution] = ode45 (@(t, y) counted_rate (arm, y), instants, y, options);
    y = solution(end,:)';
    motion = [motion; solution(2:end,:)];
  end
  printf ("race %.17g %.17g %d\n", tolerance, cputime () - begin_s, calls);
  for i = 1:rows (motion)
    printf ("y"); printf (" %.17g", motion(i,:)); printf ("\n");
  end
  fflush (stdout);
end
