% Read a golden dataset in Octave, as doubles from hexfloats: octave-cli golden.m data/golden/paris
1;
function lines = body(file)  % without the header
  lines = strsplit(strtrim(fileread(file)), "\n")(2:end);
end
function value = hexfloat(text)  % Octave reads none by itself; nothing is rounded here
  parts = regexp(text, '0x([01])\.([0-9a-f]+)p([+-]\d+)$', "tokens"){1};
  magnitude = hex2dec([parts{1}, parts{2}]) / 16 ^ numel(parts{2}) * 2 ^ str2double(parts{3});
  value = magnitude * (1 - 2 * (text(1) == "-"));
end

folder = argv(){end};
bounds = jsondecode(fileread([folder, "/manifest.json"])).bounds.grid;
grid = body([folder, "/grid.binary64.csv"]);
last = strsplit(grid{end}, ",");  % t,x,y,z,vx,vy,vz and again as hexfloats
printf("grid %d\nt %.17g\n", numel(grid), hexfloat(last{8}));
names = {"x", "y", "z", "vx", "vy", "vz"};
for i = 1:6
  printf("%s %.17g %s\n", names{i}, hexfloat(last{8 + i}), bounds.(names{i}));
end
if exist([folder, "/transits.csv"], "file")
  transits = body([folder, "/transits.csv"]);  % the last column is the bound
  largest = max(str2double(regexp(transits, '[^,]+$', "match", "once")));
  printf("transits %d %g\n", numel(transits), largest);
end
if exist([folder, "/vectors.json"], "file")
  vectors = jsondecode(fileread([folder, "/vectors.json"]));
  x = vectors.states(2).values.x.hexfloat;
  printf("vectors %d %d %s\n", numel(vectors.states), numel(vectors.transits), x);
end
