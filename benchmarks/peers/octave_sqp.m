% octave-cli octave_sqp.m STARTS.csv ENDS.csv SECONDS.txt
% GNU Octave's sqp with its own numerical gradients: a row of STARTS.csv is (z, lower bounds, upper
% bounds, start); a row of ENDS.csv is where sqp stopped from it.
files = argv ();
addpath (fileparts (mfilename ("fullpath")));
starts = csvread (files{1});
ends = zeros (rows (starts), 7);
warning ("off", "all");

function g = only_g (z, v)
  [~, g] = rp96_evaluate (z, v);
end

begun = tic ();
for k = 1:rows (starts)
  z = starts(k, 1:5)';
  lower = starts(k, 6:12)';
  upper = starts(k, 13:19)';
  v = starts(k, 20:26)';
  try
    v = sqp (v, @(v) -rp96_evaluate (z, v), [], @(v) only_g (z, v), lower, upper);
  catch
    % That start is lost: its row stays the start itself.
  end
  ends(k, :) = real (v)';
end
seconds = toc (begun);
dlmwrite (files{2}, ends, "precision", "%.17g");
dlmwrite (files{3}, seconds, "precision", "%.9g");
