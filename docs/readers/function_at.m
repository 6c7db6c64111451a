% Evaluate a golden function in Octave: octave-cli function_at.m FOLDER 17.25 3600
% Prints t, x, y, z, vx, vy, vz for each time; docs/format.md specifies the files and every operation.
1;
function values = hexfloats(texts)  % "0x1.8p+3"; nothing is rounded here
  parts = regexp(texts, '^0x([01])\.([0-9a-f]+)p([+-]\d+)$', "tokens", "once");
  parts = reshape([parts{:}], 3, [])';  % the bit before the point, the digits after it, the exponent
  digits = cellfun(@numel, parts(:, 2));
  values = hex2dec(strcat(parts(:, 1), parts(:, 2))) .* pow2(str2double(parts(:, 3)) - 4 * digits);
end

function [position, velocity] = at(t, f)  % columns x, y, z and vx, vy, vz; a row for each time
  if any(! (t >= 0 & t <= f.times(end)))
    error("a time is not within 0 to %.17g s", f.times(end));
  end
  piece = min(lookup(f.times, t), numel(f.times) - 1);  % times(piece) <= t < times(piece + 1) but at the very end
  a = f.times(piece);  b = f.times(piece + 1);  w = b - a;
  u = ((t - a) - (b - t)) ./ w;  y = u + u;
  degree = rows(f.c) - 1;  series = columns(f.c);
  position = velocity = zeros(numel(t), 3);
  for i = 1:series
    b1 = b2 = d1 = d2 = zeros(size(t));
    for k = degree:-1:1
      c = vec(f.c(k + 1, i, piece));
      b0 = (y .* b1 - b2) + c;      b2 = b1;  b1 = b0;
      d0 = (y .* d1 - d2) + k * c;  d2 = d1;  d1 = d0;
    end
    position(:, i) = (u .* b1 - b2) + vec(f.c(1, i, piece));
    velocity(:, i) = (d1 + d1) ./ w;
  end
  if series == 2
    x = position(:, 1);  y = position(:, 2);
    position(:, 3) = z = -sqrt(f.square - (x .* x + y .* y));
    velocity(:, 3) = -(x .* velocity(:, 1) + y .* velocity(:, 2)) ./ z;
  end
end

words = argv();
folder = words{1};
f = jsondecode(fileread([folder, "/function.json"]));
file = fopen([folder, "/function.f64"]);
f.c = reshape(fread(file, Inf, "double", 0, "ieee-le"), f.degree + 1, numel(f.components), []);
fclose(file);
f.times = hexfloats(f.times);
if ! isempty(f.length_squared)
  f.square = hexfloats({f.length_squared});
end
t = str2double(words(2:end)(:));
[position, velocity] = at(t, f);
printf("%.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", [t, position, velocity]');
